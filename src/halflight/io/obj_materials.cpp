#include "halflight/io/obj_materials.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "halflight/io/scene_limits.h"
#include "halflight/io/text_lines.h"
#include "halflight/scene/radiance.h"

namespace halflight {
namespace {

struct MapOptions {
  std::array<float, 3> scale{1.f, 1.f, 1.f};
  std::array<float, 3> offset{0.f, 0.f, 0.f};
  bool clamp = false;
  std::string file;
};

// "-s 2 2 1 -clamp on name with spaces.png". Numbers of -o, -s and -t: one to three.
MapOptions read_map_options(std::string_view arguments) {
  MapOptions options;
  LineWords words(arguments);
  const auto read_numbers = [&](std::array<float, 3>& numbers) {
    for (float& number : numbers) {
      LineWords ahead = words;
      const std::optional<float> value = to_number(ahead.word());
      if (!value) return;
      number = *value;
      words = ahead;
    }
  };
  while (words.rest().starts_with('-')) {
    const std::string_view option = words.word();
    std::array<float, 3> ignored{};
    if (option == "-s")
      read_numbers(options.scale);
    else if (option == "-o")
      read_numbers(options.offset);
    else if (option == "-t" || option == "-mm")
      read_numbers(ignored);
    else if (option == "-clamp")
      options.clamp = words.word() == "on";
    else
      words.word();
  }
  options.file = words.rest();
  std::replace(options.file.begin(), options.file.end(), '\\', '/');
  return options;
}

// Repetitions of a picture: far beyond, sums of scale and offset are no numbers.
constexpr float kFarthestMap = 1e6f;

// A colour of one (grey) or three numbers.
std::optional<Rgb> read_colour(LineWords words) {
  const std::optional<float> r = to_number(words.word());
  if (!r) return std::nullopt;
  if (words.empty()) return Rgb(*r);
  const std::optional<float> g = to_number(words.word()), b = to_number(words.word());
  if (!g || !b) return std::nullopt;
  return Rgb(*r, *g, *b);
}

// What the statements of one newmtl have said so far.
struct Draft {
  std::optional<Rgb> reflectance, emission;
  std::optional<float> opacity, transparency;
};

void apply(const Draft& draft, Material& m) {
  if (draft.reflectance) m.reflectance = *draft.reflectance;
  if (draft.emission)
    m.emission = *draft.emission;
  else if (m.emission_texture.valid())
    m.emission = Rgb(1.f);
  if (draft.opacity)
    m.alpha = *draft.opacity;
  else if (draft.transparency)
    m.alpha = 1.f - *draft.transparency;
  m.alpha = std::clamp(m.alpha, 0.f, 1.f);
  const bool opaque = m.alpha == 1.f && !m.alpha_texture.valid();
  m.alpha_mode = opaque ? AlphaMode::opaque : AlphaMode::blend;
}

// False when the statement is one of these and its numbers cannot be read, or be light.
bool read_numbers(std::string_view key, LineWords words, Draft& draft) {
  if (key == "Kd") return (draft.reflectance = read_colour(words)).has_value();
  if (key == "Ke") {
    draft.emission = read_colour(words);
    if (draft.emission && !is_radiance(*draft.emission)) draft.emission.reset();
    return draft.emission.has_value();
  }
  if (key == "Tr") return (draft.transparency = to_number(words.word())).has_value();
  if (key != "d") return true;
  if (words.rest().starts_with("-halo")) words.word();
  return (draft.opacity = to_number(words.word())).has_value();
}

}  // namespace

void ObjMaterials::read_library(const std::filesystem::path& path) {
  std::error_code unknown;
  const auto file = std::filesystem::weakly_canonical(path, unknown);
  if (!libraries_.insert(unknown ? path : file).second) return;
  if (libraries_.size() > kMaxLibraries)
    fail_reading("there are more than " + std::to_string(kMaxLibraries) + " material libraries",
                 path.string(), "put their materials into one file");
  Result<Bytes> text = read_file(path);
  if (!text) {
    warnings_.add(text.error().line() + "; materials without it have reflectance 0.5");
    return;
  }
  read_library(std::move(*text), path);
}

void ObjMaterials::read_library(Bytes text, const std::filesystem::path& path) {
  TextLines lines(text);
  Draft draft;
  MaterialId current;
  const auto finish = [&] {
    if (current.valid()) apply(draft, scene_.materials[current]);
    draft = {};
  };
  for (std::string_view line; lines.next(line);) {
    LineWords words(line);
    const std::string_view key = words.word();
    if (key == "newmtl") {
      finish();
      const std::string_view name = checked_name(words.rest(), path, lines.number());
      current = scene_.materials.push_back({});
      scene_.materials[current].name = name;
      by_name_.emplace(name, current);
    } else if (current.valid()) {
      if (!read_numbers(key, words, draft))
        warnings_.add(path.string() + ":" + std::to_string(lines.number()) + ": '" +
                      std::string(key) + "' has no number that can be used; it is ignored");
      read_maps(key, words.rest(), path.parent_path(), scene_.materials[current]);
    }
  }
  finish();
}

// Kd beside a texture is what viewers without textures show: most exporters write its mean. So it
// gives way to the picture, and stays where the picture is missing.
void ObjMaterials::decode_textures() {
  decode_pictures(pictures_, scene_, warnings_);
  for (Material& m : scene_.materials) {
    const TextureRef& ref = m.reflectance_texture;
    if (ref.valid() && !scene_.textures[ref.texture].texels.empty()) m.reflectance = Rgb(1.f);
  }
}

void ObjMaterials::read_maps(std::string_view key, std::string_view arguments,
                             const std::filesystem::path& folder, Material& material) {
  if (key == "map_Kd")
    material.reflectance_texture = read_map(arguments, folder, Picture::Use::colour);
  else if (key == "map_Ke")
    material.emission_texture = read_map(arguments, folder, Picture::Use::colour);
  else if (key == "map_d")
    material.alpha_texture = read_map(arguments, folder, Picture::Use::opacity);
}

MaterialId ObjMaterials::find_or_add(std::string_view name) {
  if (const auto known = by_name_.find(name); known != by_name_.end()) return known->second;
  warnings_.add("no material library has '" + std::string(name) +
                "'; it gets reflectance 0.5 and no emission");
  Material material;
  material.name = name;
  const MaterialId id = scene_.materials.push_back(std::move(material));
  by_name_.emplace(name, id);
  return id;
}

MaterialId ObjMaterials::unnamed() {
  const auto [entry, added] = by_name_.emplace("", MaterialId());
  if (added) {
    entry->second = scene_.materials.push_back({});
    scene_.materials.back().name = "default";
  }
  return entry->second;
}

TextureRef ObjMaterials::read_map(std::string_view arguments, const std::filesystem::path& folder,
                                  Picture::Use use) {
  const MapOptions options = read_map_options(arguments);
  TextureRef ref;
  if (options.file.empty()) return ref;
  ref.texture = texture(folder / options.file, options.clamp ? Wrap::clamp : Wrap::repeat, use);
  // OBJ: u' = s u + o with v from the bottom; v is flipped before and after.
  const auto& s = options.scale;
  const auto& o = options.offset;
  if (std::max({std::abs(s[0]), std::abs(s[1]), std::abs(o[0]), std::abs(o[1])}) > kFarthestMap) {
    warnings_.add(options.file + " is scaled or moved by more than a million; that is ignored");
    return ref;
  }
  ref.uv_transform = {s[0], 0.f, o[0], 0.f, s[1], 1.f - s[1] - o[1]};
  return ref;
}

TextureId ObjMaterials::texture(const std::filesystem::path& path, Wrap wrap, Picture::Use use) {
  const std::string file = path.lexically_normal().string();
  const std::string key = file + (wrap == Wrap::clamp ? "|clamp" : "|repeat") +
                          (use == Picture::Use::opacity ? "|opacity" : "|colour");
  const auto [known, added] = texture_of_key_.emplace(key, TextureId());
  if (!added) return known->second;
  Texture texture;
  texture.name = path.filename().string();
  texture.wrap_u = texture.wrap_v = wrap;
  known->second = scene_.textures.push_back(std::move(texture));

  const auto [picture, first_use] = picture_of_path_.emplace(file, pictures_.size());
  if (first_use) {
    pictures_.push_back({});
    pictures_.back().where = file;
    Result<Bytes> bytes = read_file(file);
    if (bytes) pictures_.back().owned = std::move(*bytes);
    pictures_.back().bytes = pictures_.back().owned;
    if (!bytes) pictures_.back().missing = bytes.error().line();
  }
  pictures_[picture->second].shown.push_back({known->second, use});
  return known->second;
}

}  // namespace halflight
