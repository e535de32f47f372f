#include "halflight/io/gltf_materials.h"

#include <cmath>

#include "halflight/scene/radiance.h"

namespace halflight {
namespace {

Wrap read_wrap(const JsonCursor& sampler, std::string_view key) {
  switch (sampler.count_or(key, 10497)) {
    case 10497:
      return Wrap::repeat;
    case 33071:
      return Wrap::clamp;
    case 33648:
      return Wrap::mirror;
    default:
      sampler.at(key).fail("this is not a wrap mode");
  }
}

AlphaMode read_alpha_mode(const JsonCursor& material) {
  const std::string mode = material.string_or("alphaMode", "OPAQUE");
  if (mode == "OPAQUE") return AlphaMode::opaque;
  if (mode == "MASK") return AlphaMode::mask;
  if (mode == "BLEND") return AlphaMode::blend;
  material.at("alphaMode").fail("'" + mode + "' is not an alpha mode");
}

// KHR_texture_transform: scale first, then turn (counter-clockwise as seen, with v downwards), then
// shift.
std::array<float, 6> read_uv_transform(const JsonCursor& extension) {
  std::array<float, 2> offset{0.f, 0.f}, scale{1.f, 1.f};
  extension.read_numbers("offset", 2, offset);
  extension.read_numbers("scale", 2, scale);
  const float angle = extension.float_or("rotation", 0.f);
  const float c = std::cos(angle), s = std::sin(angle);
  return {c * scale[0], s * scale[1], offset[0], -s * scale[0], c * scale[1], offset[1]};
}

}  // namespace

MaterialId GltfMaterials::read(const JsonCursor& index) {
  const JsonCursor json = document_.element("materials", index);
  const auto [known, added] = material_of_index_.try_emplace(index.count());
  if (added) known->second = scene_.materials.push_back(read_material(json));
  return known->second;
}

MaterialId GltfMaterials::default_material() {
  if (!default_.valid()) {
    Material material;
    material.name = "default";
    material.reflectance = Rgb(1.f);
    default_ = scene_.materials.push_back(std::move(material));
  }
  return default_;
}

Material GltfMaterials::read_material(const JsonCursor& json) {
  Material m;
  m.name = json.name();
  m.alpha_mode = read_alpha_mode(json);
  m.alpha_cutoff = json.float_or("alphaCutoff", 0.5f);
  m.double_sided = json.boolean_or("doubleSided", false);
  read_base_colour(json, m);
  read_emission(json, m);
  if (const auto transmission = json.extension("KHR_materials_transmission")) {
    m.transmission = transmission->float_or("transmissionFactor", 0.f);
    if (m.transmission < 0.f || m.transmission > 1.f)
      transmission->at("transmissionFactor").fail("this should be between 0 and 1");
    if (transmission->has("transmissionTexture"))
      warnings_.add(transmission->path() + ": transmissionTexture is ignored; the factor counts");
  }
  return m;
}

// KHR_materials_pbrSpecularGlossiness replaces the base colour with its diffuse part.
void GltfMaterials::read_base_colour(const JsonCursor& json, Material& m) {
  const auto glossy = json.extension("KHR_materials_pbrSpecularGlossiness");
  const auto metallic = json.find("pbrMetallicRoughness");
  std::array<float, 4> factor{1.f, 1.f, 1.f, 1.f};
  if (glossy) {
    glossy->read_numbers("diffuseFactor", 4, factor);
    if (const auto texture = glossy->find("diffuseTexture"))
      m.reflectance_texture = read_texture_ref(*texture);
  } else if (metallic) {
    metallic->read_numbers("baseColorFactor", 4, factor);
    if (const auto texture = metallic->find("baseColorTexture"))
      m.reflectance_texture = read_texture_ref(*texture);
  }
  m.reflectance = Rgb(factor[0], factor[1], factor[2]);
  m.alpha = factor[3];
  if (min_component(m.reflectance) < 0.f || m.alpha < 0.f)
    json.fail("the base colour is negative", "give it a colour between 0 and 1");
}

void GltfMaterials::read_emission(const JsonCursor& json, Material& m) {
  json.read_numbers("emissiveFactor", 3, m.emission);
  if (const auto strength = json.extension("KHR_materials_emissive_strength"))
    m.emission *= strength->float_or("emissiveStrength", 1.f);
  if (!is_radiance(m.emission))
    json.fail("the emission is negative or too large", "give it a radiance in W/m2/sr or nits");
  if (const auto texture = json.find("emissiveTexture"); texture && m.emits())
    m.emission_texture = read_texture_ref(*texture);
}

TextureRef GltfMaterials::read_texture_ref(const JsonCursor& info) {
  TextureRef ref;
  ref.texture = read_texture(info.at("index"));
  std::size_t uv_set = info.count_or("texCoord", 0);
  if (const auto transform = info.extension("KHR_texture_transform")) {
    ref.uv_transform = read_uv_transform(*transform);
    uv_set = transform->count_or("texCoord", uv_set);
  }
  if (uv_set > 1) {
    warnings_.add(info.path() +
                  ": only TEXCOORD_0 and TEXCOORD_1 are read; the texture is ignored");
    return {};
  }
  ref.uv_set = static_cast<int>(uv_set);
  return ref;
}

TextureId GltfMaterials::read_texture(const JsonCursor& index) {
  const JsonCursor json = document_.element("textures", index);
  const auto source = json.find("source");
  if (!source) {
    warnings_.add(json.path() + ": the texture has no PNG or JPEG picture and is ignored");
    return {};
  }
  Texture texture;
  if (const auto sampler_index = json.find("sampler")) {
    const JsonCursor sampler = document_.element("samplers", *sampler_index);
    texture.wrap_u = read_wrap(sampler, "wrapS");
    texture.wrap_v = read_wrap(sampler, "wrapT");
  }
  const std::size_t image = picture(*source);
  const auto [known, added] = texture_of_key_.try_emplace({image, texture.wrap_u, texture.wrap_v});
  if (added) {
    const JsonCursor image_json = document_.element("images", *source);
    texture.name = json.has("name") ? json.name() : image_json.name();
    known->second = scene_.textures.push_back(std::move(texture));
    pictures_[image].shown.push_back({known->second, Picture::Use::colour});
  }
  return known->second;
}

// Its place in pictures_. Images of the same bytes are one.
std::size_t GltfMaterials::picture(const JsonCursor& image_index) {
  const JsonCursor json = document_.element("images", image_index);
  const auto [known, added] = picture_of_image_.try_emplace(image_index.count(), pictures_.size());
  if (!added) return known->second;
  Picture picture;
  picture.where = json.path();
  if (const auto view = json.find("bufferView")) {
    picture.bytes = document_.buffer_view(*view);
  } else if (const auto bytes = document_.resolve_uri(json.at("uri").string(), json.path())) {
    picture.bytes = *bytes;
  } else {
    picture.missing = bytes.error().line();
  }
  if (picture.missing.empty())
    known->second =
        picture_of_bytes_.try_emplace({picture.bytes.data(), picture.bytes.size()}, known->second)
            .first->second;
  if (known->second == pictures_.size()) pictures_.push_back(std::move(picture));
  return known->second;
}

}  // namespace halflight
