#include "halflight/io/lit_material.h"

namespace halflight {
namespace {

using nlohmann::json;

// Clear glass stays visible in a viewer that knows no refraction.
constexpr float kLeastOpacity = 0.08f;

void set_base_color(json& pbr, const Rgb& factor, float alpha, json texture) {
  pbr = {{"baseColorFactor", {factor.r, factor.g, factor.b, alpha}},
         {"metallicFactor", 0.0},
         {"roughnessFactor", 1.0}};
  if (!texture.is_null()) pbr["baseColorTexture"] = std::move(texture);
}

// Mode and constant part of the opacity (1 - transmission) x alpha.
float set_alpha(json& j, const Material& m) {
  float alpha = m.alpha_mode == AlphaMode::opaque ? 1.f : m.alpha;
  if (m.transmission > 0.f) {
    j["alphaMode"] = "BLEND";
    alpha *= 1.f - m.transmission;
  } else if (m.alpha_mode == AlphaMode::blend) {
    j["alphaMode"] = "BLEND";
  } else if (m.alpha_mode == AlphaMode::mask) {
    j["alphaMode"] = "MASK";
    j["alphaCutoff"] = m.alpha_cutoff;
  }
  if (j.value("alphaMode", "") == "BLEND") alpha = std::max(alpha, kLeastOpacity);
  return std::clamp(alpha, 0.f, 1.f);
}

}  // namespace

// A viewer multiplies one colour texture by COLOR_0, while rho and L may have a texture each:
//   no emission          factor rho     texture rho    COLOR_0 of E / pi
//   emission texture     factor 1       texture of L   rho E / pi + L: exact when rho has the same
//                                                      texture, else the faint reflected part is
//                                                      tinted
//   rho texture only     factor rho     texture rho    E / pi + L / rho, unless L alone saturates
//   no texture           factor 1       none           rho E / pi + L
// A texture that cuts holes (alpha) is always kept.
LitMaterial lit_material(const Material& m, bool emits, float exposure, TextureWriter& textures) {
  LitMaterial lit;
  lit.json["extensions"]["KHR_materials_unlit"] = json::object();
  if (!m.name.empty()) lit.json["name"] = m.name;
  const float alpha = set_alpha(lit.json, m);
  json& pbr = lit.json["pbrMetallicRoughness"];
  const Rgb rho = glm::clamp(m.reflectance, Rgb(0.f), Rgb(1.f));
  json rho_texture = textures.base_color(m);
  if (!emits) {
    set_base_color(pbr, rho, alpha, std::move(rho_texture));
    return lit;
  }
  const bool cuts_holes = m.alpha_mode != AlphaMode::opaque && !rho_texture.is_null();
  const bool saturates = exposure * min_component(m.emission) >= 1.f;
  if (m.emission_texture.valid() && !cuts_holes) {
    set_base_color(pbr, Rgb(1.f), alpha, textures.info(m.emission_texture));
  } else if (!rho_texture.is_null() && (cuts_holes || !saturates)) {
    const Rgb factor = glm::max(rho, Rgb(0.02f));
    set_base_color(pbr, factor, alpha, std::move(rho_texture));
    lit.irradiance_weight = rho / factor;
    lit.emission = m.emission / factor;
    return lit;
  } else {
    set_base_color(pbr, Rgb(1.f), alpha, json());
  }
  lit.irradiance_weight = rho;
  lit.emission = m.emission;
  return lit;
}

}  // namespace halflight
