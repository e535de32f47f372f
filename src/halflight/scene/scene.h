// The scene as arrays, as read from a file: nodes place meshes, meshes hold primitives of
// triangles. Lengths are in the file's own unit until `to_world` (metres, +Y up) is applied; see
// geometry.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "halflight/base/ids.h"
#include "halflight/base/vec.h"

namespace halflight {

using NodeId = Id<struct NodeTag>;
using MeshId = Id<struct MeshTag>;
using MaterialId = Id<struct MaterialTag>;
using TextureId = Id<struct TextureTag>;
using LightId = Id<struct LightTag>;
using CameraId = Id<struct CameraTag>;

enum class Wrap { repeat, mirror, clamp };

struct Texture {
  std::string name;
  int width = 0;
  int height = 0;
  // Row 0 is the top of the picture; sRGB-encoded colour, linear alpha.
  std::vector<std::array<std::uint8_t, 4>> texels;
  Wrap wrap_u = Wrap::repeat;
  Wrap wrap_v = Wrap::repeat;
  // The file's bytes, kept for output when they are PNG or JPEG; empty otherwise.
  std::vector<std::uint8_t> encoded;
  std::string mime_type;
};

// Where and how a material looks a texture up. The uv transform is the 2x3 affine matrix of
// KHR_texture_transform: u' = m[0] u + m[1] v + m[2], v' = m[3] u + m[4] v + m[5].
// v grows downwards from the top of the picture (glTF convention, OBJ is flipped on reading).
struct TextureRef {
  TextureId texture;
  int uv_set = 0;
  std::array<float, 6> uv_transform{1, 0, 0, 0, 1, 0};
  bool valid() const { return texture.valid(); }
};

enum class AlphaMode { opaque, mask, blend };

struct Material {
  std::string name;
  Rgb reflectance{0.5f};  // base colour factor, Kd
  TextureRef reflectance_texture;
  Rgb emission{0.f};  // radiance L per steradian; exitance is pi L
  TextureRef emission_texture;
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha = 1.f;  // base colour alpha, OBJ d
  float alpha_cutoff = 0.5f;
  TextureRef alpha_texture;  // OBJ map_d, as its alpha; glTF alpha is that of reflectance_texture
  float transmission =
      0.f;  // KHR_materials_transmission; opacity is multiplied by 1 - transmission
  bool double_sided = false;  // emission leaves the back side too

  bool emits() const { return max_component(emission) > 0.f; }
};

struct Primitive {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;                            // empty or one per position
  std::array<std::vector<Vec2>, 2> uvs;                 // each empty or one per position
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from the front
  MaterialId material;                                  // always valid
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
};

struct Light {  // KHR_lights_punctual, at the node's origin, shining along the node's -Z
  enum class Kind { point, spot, directional };
  std::string name;
  Kind kind = Kind::point;
  Rgb intensity{0.f};  // candela (point, spot) or lux (directional), colour included
  float range = kInfinity;
  float inner_cone_angle = 0.f;  // radians from the axis
  float outer_cone_angle = kPi / 4;
};

struct Camera {  // at the node's origin, looking along the node's -Z, +Y up
  std::string name;
  bool perspective = true;
  float vertical_fov = 0.8f;  // radians, perspective
  float aspect = 0.f;         // width / height; 0: that of the picture
  float half_height = 1.f;    // orthographic
};

struct Node {
  std::string name;
  NodeId parent;
  Mat4 local{1.0};
  MeshId mesh;
  LightId light;
  CameraId camera;
  std::vector<Mat4> instances;  // EXT_mesh_gpu_instancing; empty: the mesh appears once
};

struct Scene {
  IdVector<NodeId, Node> nodes;  // parents come before their children
  IdVector<MeshId, Mesh> meshes;
  IdVector<MaterialId, Material> materials;
  IdVector<TextureId, Texture> textures;
  IdVector<LightId, Light> lights;
  IdVector<CameraId, Camera> cameras;
  Rgb sky{0.f};                       // constant radiance of everything beyond the scene
  Mat4 to_world{1.0};                 // from the file's coordinates to metres, +Y up
  std::vector<std::string> warnings;  // what the reader tolerated, one line each
};

// Scene-to-world transform of every node (without to_world).
IdVector<NodeId, Mat4> global_transforms(const Scene& scene);

}  // namespace halflight
