#include "halflight/io/read_obj.h"

#include "halflight/io/obj_materials.h"
#include "halflight/io/obj_meshes.h"
#include "halflight/io/polygon.h"
#include "halflight/io/scene_limits.h"
#include "halflight/io/text_lines.h"

namespace halflight {
namespace {

// Something tolerated, and where it happened first.
struct Tally {
  std::size_t count = 0, first_line = 0;
  void add(std::size_t line) {
    if (count++ == 0) first_line = line;
  }
};

// 1-based from the front, or negative from the back of what has been read so far.
template <class T>
std::uint32_t resolve(std::string_view word, const std::vector<T>& items) {
  const std::int64_t index = to_integer(word).value_or(0);
  const auto n = static_cast<std::int64_t>(items.size());
  if (index > 0 && index <= n) return static_cast<std::uint32_t>(index - 1);
  if (index < 0 && index >= -n) return static_cast<std::uint32_t>(n + index);
  return ObjCorner::kNone;
}

class ObjReader {
 public:
  ObjReader(Bytes text, std::filesystem::path path)
      : path_(std::move(path)), text_(std::move(text)), materials_(scene_, warnings_) {}

  Scene read() {
    check_encoding();
    TextLines lines(text_);
    for (std::string_view line; lines.next(line);) read_statement(line, lines.number());
    meshes_.build(data_, path_.stem().string(), scene_);
    materials_.decode_textures();
    report_tallies();
    scene_.warnings = warnings_.take();
    return std::move(scene_);
  }

 private:
  void check_encoding() const {
    const bool utf16 = text_.size() >= 2 && ((text_[0] == 0xff && text_[1] == 0xfe) ||
                                             (text_[0] == 0xfe && text_[1] == 0xff));
    if (utf16) fail_reading("the file is UTF-16 text", path_.string(), "save it as UTF-8 or ASCII");
    if (text_.empty()) fail_reading("the file is empty", path_.string(), "export the scene again");
  }

  void read_statement(std::string_view line, std::size_t number) {
    LineWords words(line);
    const std::string_view key = words.word();
    if (key == "v")
      data_.positions.push_back(read_vector(words, number));
    else if (key == "vn")
      data_.normals.push_back(read_vector(words, number));
    else if (key == "vt")
      data_.uvs.push_back(read_uv(words, number));
    else if (key == "f")
      read_face(words, number);
    else if (key == "p" || key == "l")
      points_and_lines_.add(number);
    else if (key == "o" || key == "g")
      start_group(key == "o", checked_name(words.rest(), path_, number));
    else if (key == "usemtl")
      start_material(checked_name(words.rest(), path_, number));
    else if (key == "mtllib")
      read_libraries(words.rest());
  }

  // NaN marks what cannot be read: faces that use it are left out.
  Vec3 read_vector(LineWords& words, std::size_t line) {
    Vec3 v(0.f);
    for (int k = 0; k < 3; ++k) {
      const std::optional<float> value = to_number(words.word());
      if (!value) {
        bad_vertices_.add(line);
        return Vec3(std::numeric_limits<float>::quiet_NaN());
      }
      v[k] = *value;
    }
    return v;
  }

  // v counts from the bottom of the picture in OBJ, from its top in the scene.
  Vec2 read_uv(LineWords& words, std::size_t line) {
    const std::optional<float> u = to_number(words.word());
    const std::optional<float> v = words.empty() ? 0.f : to_number(words.word());
    if (!u || !v) bad_vertices_.add(line);
    return {u.value_or(0.f), 1.f - v.value_or(0.f)};
  }

  // "7", "7/2", "7//3" or "7/2/3".
  ObjCorner read_corner(std::string_view word, std::size_t line) {
    const auto take = [&] {
      const std::size_t slash = std::min(word.find('/'), word.size());
      const std::string_view part = word.substr(0, slash);
      word.remove_prefix(std::min(slash + 1, word.size()));
      return part;
    };
    const auto optional_index = [&](const auto& items) {
      const std::string_view part = take();
      const std::uint32_t index = part.empty() ? ObjCorner::kNone : resolve(part, items);
      if (!part.empty() && index == ObjCorner::kNone) bad_attributes_.add(line);
      return index;
    };
    ObjCorner corner;
    corner.position = resolve(take(), data_.positions);
    corner.uv = optional_index(data_.uvs);
    corner.normal = optional_index(data_.normals);
    return corner;
  }

  void read_face(LineWords& words, std::size_t line) {
    face_.clear();
    outline_.clear();
    bool usable = true;
    while (!words.empty() && !words.rest().starts_with('#')) {
      face_.push_back(read_corner(words.word(), line));
      const std::uint32_t position = face_.back().position;
      usable = usable && position != ObjCorner::kNone && is_finite(data_.positions[position]);
      outline_.push_back(usable ? data_.positions[position] : Vec3(0.f));
    }
    if (!usable || face_.size() < 3) return bad_faces_.add(line);
    effort_ += cutting_effort(face_.size());
    if (effort_ > kMaxCuttingEffort)
      fail_reading("too many faces have hundreds of corners", place(line),
                   "triangulate them when exporting");
    cut_.clear();
    triangulate_polygon(outline_, cut_);
    triangles_.take(cut_.size(), path_.string());
    for (const auto& [a, b, c] : cut_) faces().push_back({face_[a], face_[b], face_[c]});
  }

  ObjMeshes::Triangles& faces() {
    if (!material_.valid()) material_ = materials_.unnamed();
    if (!faces_) faces_ = &meshes_.faces(object_, group_, material_);
    return *faces_;
  }

  void start_group(bool is_object, std::string_view name) {
    if (is_object) group_.clear();
    (is_object ? object_ : group_) = name;
    faces_ = nullptr;
  }

  void start_material(std::string_view name) {
    material_ = materials_.find_or_add(name);
    faces_ = nullptr;
  }

  // One file name with spaces, or several names.
  void read_libraries(std::string_view names) {
    const auto library = [&](std::string_view name) {
      std::string file(name);
      std::replace(file.begin(), file.end(), '\\', '/');
      return path_.parent_path() / file;
    };
    std::error_code error;
    if (std::filesystem::is_regular_file(library(names), error))
      return materials_.read_library(library(names));
    for (LineWords words(names); !words.empty();) materials_.read_library(library(words.word()));
  }

  std::string place(std::size_t line) const { return path_.string() + ":" + std::to_string(line); }

  void report_tallies() {
    const auto report = [&](const Tally& tally, const std::string& what) {
      if (tally.count > 0)
        warnings_.add(place(tally.first_line) + ": " + what + " (" + std::to_string(tally.count) +
                      " in all)");
    };
    report(bad_vertices_,
           "a vertex, normal or texture coordinate has too few numbers that can be "
           "read; faces that use such a vertex are left out");
    report(bad_faces_,
           "a face is left out: it has fewer than three corners, or vertices that are "
           "not there or cannot be read");
    report(bad_attributes_, "a face refers to a normal or texture coordinate that is not there");
    report(points_and_lines_, "points and lines are ignored");
    if (meshes_.empty()) warnings_.add(path_.string() + ": there are no faces in it");
  }

  std::filesystem::path path_;
  Bytes text_;
  Scene scene_;
  ReadWarnings warnings_;
  ObjMaterials materials_;
  ObjVertexData data_;
  ObjMeshes meshes_{path_.string()};
  ReadBudget triangles_{"triangles", kMaxTriangles};
  std::size_t effort_ = 0;  // of cutting faces

  std::string object_, group_;             // as the last o and g said
  MaterialId material_;                    // as the last usemtl said
  ObjMeshes::Triangles* faces_ = nullptr;  // where they put faces; looked up when null

  std::vector<ObjCorner> face_;  // of read_face
  std::vector<Vec3> outline_;
  std::vector<std::array<std::uint32_t, 3>> cut_;

  Tally bad_vertices_, bad_faces_, bad_attributes_, points_and_lines_;
};

}  // namespace

Scene read_obj(Bytes text, const std::filesystem::path& path) {
  return ObjReader(std::move(text), path).read();
}

}  // namespace halflight
