#include "halflight/io/gltf_parts.h"

#include <glm/gtc/matrix_transform.hpp>

#include "halflight/io/encode_png.h"

namespace halflight {
namespace {

using nlohmann::json;

constexpr int kRepeat = 10497, kMirroredRepeat = 33648, kClampToEdge = 33071;
constexpr int kLinear = 9729, kLinearMipmapLinear = 9987;
constexpr std::array<std::uint8_t, 4> kWhite{255, 255, 255, 255};
// glTF wants clipping planes; a camera of ours has none.
constexpr double kNearPlane = 0.01, kFarPlane = 1e4;

int wrap_code(Wrap w) {
  switch (w) {
    case Wrap::mirror:
      return kMirroredRepeat;
    case Wrap::clamp:
      return kClampToEdge;
    case Wrap::repeat:
      break;
  }
  return kRepeat;
}

// KHR_texture_transform, counter-clockwise as seen with v downwards:
// u' = sx cos(r) u + sy sin(r) v + ox, v' = -sx sin(r) u + sy cos(r) v + oy.
json transform_json(const std::array<float, 6>& m) {
  const double rotation = std::atan2(-m[3], m[0]);
  const double scale_u = std::hypot(m[0], m[3]);
  const double scale_v = m[4] * std::cos(rotation) + m[1] * std::sin(rotation);
  json j{{"offset", {m[2], m[5]}}, {"scale", {scale_u, scale_v}}};
  if (rotation != 0.0) j["rotation"] = rotation;
  return j;
}

// Nearest texel, wrapped by size: pictures of one material usually have the same size.
template <class Texels>
const auto& texel(const Texels& t, int width, int height, int column, int row, int columns,
                  int rows) {
  const int x = static_cast<int>((2LL * column + 1) * width / (2LL * columns));
  const int y = static_cast<int>((2LL * row + 1) * height / (2LL * rows));
  return t[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x)];
}

}  // namespace

const Texture* TextureWriter::picture(TextureId id) const {
  return id.valid() && !scene_.textures[id].texels.empty() ? &scene_.textures[id] : nullptr;
}

int TextureWriter::add(const Texture& t, const std::vector<std::uint8_t>& encoded,
                       const std::string& mime_type) {
  const int image = glb_.add_image(encoded, mime_type, t.name);
  const int sampler = glb_.append("samplers", {{"wrapS", wrap_code(t.wrap_u)},
                                               {"wrapT", wrap_code(t.wrap_v)},
                                               {"magFilter", kLinear},
                                               {"minFilter", kLinearMipmapLinear}});
  return glb_.append("textures", {{"source", image}, {"sampler", sampler}});
}

int TextureWriter::texture(TextureId id) {
  const auto [entry, is_new] = written_.try_emplace({id, TextureId()}, 0);
  if (!is_new) return entry->second;
  const Texture& t = scene_.textures[id];
  const bool as_read = t.mime_type == "image/png" || t.mime_type == "image/jpeg";
  if (as_read && !t.encoded.empty())
    entry->second = add(t, t.encoded, t.mime_type);
  else if (picture(id))
    entry->second = add(t, encode_png(t.width, t.height, t.texels), "image/png");
  else  // a picture that could not be read counts as white
    entry->second = add(t, encode_png(1, 1, {&kWhite, 1}), "image/png");
  return entry->second;
}

int TextureWriter::merged(TextureId color, TextureId alpha) {
  const auto [entry, is_new] = written_.try_emplace({color, alpha}, 0);
  if (!is_new) return entry->second;
  const Texture& a = scene_.textures[alpha];
  const Texture* c = picture(color);
  Texture both;
  both.name = a.name;
  both.wrap_u = a.wrap_u;
  both.wrap_v = a.wrap_v;
  both.width = a.width;
  both.height = a.height;
  if (c) {
    both.width = std::max(a.width, c->width);
    both.height = std::max(a.height, c->height);
  }
  both.texels.reserve(static_cast<std::size_t>(both.width) * static_cast<std::size_t>(both.height));
  for (int row = 0; row < both.height; ++row)
    for (int column = 0; column < both.width; ++column) {
      std::array<std::uint8_t, 4> rgba = kWhite;
      if (c) rgba = texel(c->texels, c->width, c->height, column, row, both.width, both.height);
      rgba[3] = texel(a.texels, a.width, a.height, column, row, both.width, both.height)[3];
      both.texels.push_back(rgba);
    }
  entry->second = add(both, encode_png(both.width, both.height, both.texels), "image/png");
  return entry->second;
}

json TextureWriter::info(const TextureRef& ref) { return placed(texture(ref.texture), ref); }

json TextureWriter::placed(int index, const TextureRef& ref) {
  json j{{"index", index}};
  if (ref.uv_set != 0) j["texCoord"] = ref.uv_set;
  if (ref.uv_transform != TextureRef().uv_transform) {
    j["extensions"]["KHR_texture_transform"] = transform_json(ref.uv_transform);
    glb_.use_extension("KHR_texture_transform");
  }
  return j;
}

json TextureWriter::base_color(const Material& m) {
  if (!picture(m.alpha_texture.texture))
    return m.reflectance_texture.valid() ? info(m.reflectance_texture) : json();
  // The merged picture lies where the colour lies; a differing place of the alpha is not followed.
  const TextureRef& place = m.reflectance_texture.valid() ? m.reflectance_texture : m.alpha_texture;
  return placed(merged(m.reflectance_texture.texture, m.alpha_texture.texture), place);
}

std::optional<Trs> decompose(const Mat4& m) {
  constexpr double kSkew = 1e-5;  // cosine between axes; the validator tolerates about this much
  Trs trs;
  trs.translation = glm::dvec3(m[3]);
  glm::dmat3 axes(m);
  for (int k = 0; k < 3; ++k) {
    trs.scale[k] = glm::length(axes[k]);
    if (!(trs.scale[k] > 0.0) || !std::isfinite(trs.scale[k])) return std::nullopt;
    axes[k] /= trs.scale[k];
  }
  for (int k = 0; k < 3; ++k)
    if (!(std::abs(glm::dot(axes[k], axes[(k + 1) % 3])) < kSkew)) return std::nullopt;
  if (glm::determinant(axes) < 0.0) {
    trs.scale[0] = -trs.scale[0];
    axes[0] = -axes[0];
  }
  trs.rotation = glm::normalize(glm::quat_cast(axes));
  return trs;
}

json camera_json(const Camera& c) {
  json j{{"type", c.perspective ? "perspective" : "orthographic"}};
  if (!c.name.empty()) j["name"] = c.name;
  if (c.perspective) {
    j["perspective"] = {{"yfov", c.vertical_fov}, {"znear", kNearPlane}};
    if (c.aspect > 0.f) j["perspective"]["aspectRatio"] = c.aspect;
  } else {
    const float aspect = c.aspect > 0.f ? c.aspect : 1.f;
    j["orthographic"] = {{"xmag", c.half_height * aspect},
                         {"ymag", c.half_height},
                         {"znear", kNearPlane},
                         {"zfar", kFarPlane}};
  }
  return j;
}

json light_json(const Light& light) {
  const float intensity = max_component(light.intensity);
  const Rgb color = intensity > 0.f ? light.intensity / intensity : Rgb(1.f);
  json j{{"intensity", std::max(0.f, intensity)}, {"color", {color.r, color.g, color.b}}};
  if (!light.name.empty()) j["name"] = light.name;
  switch (light.kind) {
    case Light::Kind::point:
      j["type"] = "point";
      break;
    case Light::Kind::directional:
      j["type"] = "directional";
      break;
    case Light::Kind::spot:
      j["type"] = "spot";
      j["spot"] = {{"innerConeAngle", light.inner_cone_angle},
                   {"outerConeAngle", light.outer_cone_angle}};
      break;
  }
  if (light.kind != Light::Kind::directional && std::isfinite(light.range) && light.range > 0.f)
    j["range"] = light.range;
  return j;
}

json node_json(const Node& node, const Mat4& local, GlbBuilder& glb) {
  json j = json::object();
  if (!node.name.empty()) j["name"] = node.name;
  if (local != Mat4(1.0)) {
    json& matrix = j["matrix"];
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row) matrix.push_back(local[column][row]);
  }
  if (node.camera.valid()) j["camera"] = node.camera.value;
  if (node.light.valid()) {
    j["extensions"]["KHR_lights_punctual"]["light"] = node.light.value;
    glb.use_extension("KHR_lights_punctual");
  }
  return j;
}

void write_cameras_and_lights(const Scene& scene, GlbBuilder& glb) {
  for (const Camera& c : scene.cameras) glb.append("cameras", camera_json(c));
  for (const Light& l : scene.lights) {
    glb.document["extensions"]["KHR_lights_punctual"]["lights"].push_back(light_json(l));
    glb.use_extension("KHR_lights_punctual");
  }
}

int uv_sets_needed(const Material& m) {
  int sets = 0;
  for (const TextureRef* ref : {&m.reflectance_texture, &m.emission_texture, &m.alpha_texture})
    if (ref->valid()) sets = std::max(sets, ref->uv_set + 1);
  return sets;
}

}  // namespace halflight
