#include "halflight/scene/scene_digest.h"

#include "halflight/base/digest.h"

namespace halflight {
namespace {

template <class T>
void add(Digest& digest, const std::vector<T>& items) {
  digest.add(std::span<const T>(items));
}

void add(Digest& digest, const TextureRef& ref) {
  digest.add(ref.texture);
  digest.add(ref.uv_set);
  digest.add(ref.uv_transform);
}

void add(Digest& digest, const Texture& t) {
  digest.add(t.width);
  digest.add(t.height);
  add(digest, t.texels);
  digest.add(t.wrap_u);
  digest.add(t.wrap_v);
}

void add(Digest& digest, const Material& m) {
  digest.add(m.reflectance);
  add(digest, m.reflectance_texture);
  digest.add(m.emission);
  add(digest, m.emission_texture);
  digest.add(m.alpha_mode);
  digest.add(m.alpha);
  digest.add(m.alpha_cutoff);
  add(digest, m.alpha_texture);
  digest.add(m.transmission);
  digest.add(static_cast<int>(m.double_sided));
}

void add(Digest& digest, const Light& light) {
  digest.add(light.kind);
  digest.add(light.intensity);
  digest.add(light.range);
  digest.add(light.inner_cone_angle);
  digest.add(light.outer_cone_angle);
}

void add(Digest& digest, const Mesh& mesh) {
  digest.add(mesh.primitives.size());
  for (const Primitive& p : mesh.primitives) {
    add(digest, p.positions);
    add(digest, p.normals);
    for (const auto& uv : p.uvs) add(digest, uv);
    add(digest, p.triangles);
    digest.add(p.material);
  }
}

void add(Digest& digest, const Node& node) {
  digest.add(node.parent);
  digest.add(node.local);
  digest.add(node.mesh);
  digest.add(node.light);
  add(digest, node.instances);
}

template <class IdT, class T>
void add_each(Digest& digest, const IdVector<IdT, T>& items) {
  digest.add(items.size());
  for (const T& item : items) add(digest, item);
}

}  // namespace

std::uint64_t digest_of(const Scene& scene) {
  Digest digest;
  add_each(digest, scene.nodes);
  add_each(digest, scene.meshes);
  add_each(digest, scene.materials);
  add_each(digest, scene.textures);
  add_each(digest, scene.lights);
  digest.add(scene.sky);
  digest.add(scene.to_world);
  return digest.value();
}

}  // namespace halflight
