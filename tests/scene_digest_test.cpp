// Checkpoints know their scene by it: all that light depends on changes it, and nothing else does.
#include <functional>

#include <gtest/gtest.h>

#include "halflight/scene/scene_digest.h"
#include "quad_scene.h"

namespace halflight {
namespace {

using testing::QuadScene;

Scene scene_of_everything() {
  QuadScene quads;
  Texture t;
  t.width = t.height = 1;
  t.texels = {{10, 20, 30, 40}};
  const TextureId texture = quads.scene.textures.push_back(t);
  const MaterialId paper = quads.material(0.5f, 1.f);
  quads.scene.materials[paper].reflectance_texture.texture = texture;
  quads.scene.materials[paper].emission_texture.texture = texture;
  quads.scene.materials[paper].alpha_texture.texture = texture;
  quads.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, paper);
  quads.scene.meshes[MeshId(0)].primitives[0].normals.assign(4, Vec3(0, 0, 1));
  Node lamp;
  lamp.light = quads.scene.lights.push_back({});
  lamp.parent = NodeId(0);
  lamp.instances = {Mat4(1.0)};
  quads.scene.nodes.push_back(lamp);
  return quads.scene;
}

struct Change {
  const char* what;
  std::function<void(Scene&)> make;
};

std::ostream& operator<<(std::ostream& out, const Change& change) { return out << change.what; }

Material& material(Scene& s) { return s.materials[MaterialId(0)]; }
Texture& texture(Scene& s) { return s.textures[TextureId(0)]; }
Light& light(Scene& s) { return s.lights[LightId(0)]; }
Primitive& primitive(Scene& s) { return s.meshes[MeshId(0)].primitives[0]; }
Node& node(Scene& s) { return s.nodes[NodeId(1)]; }

class WhatLightDependsOn : public ::testing::TestWithParam<Change> {};

TEST_P(WhatLightDependsOn, ChangesTheDigest) {
  Scene changed = scene_of_everything();
  const std::uint64_t before = digest_of(changed);
  GetParam().make(changed);
  EXPECT_NE(digest_of(changed), before);
}

INSTANTIATE_TEST_SUITE_P(
    Is, WhatLightDependsOn,
    ::testing::Values(
        Change{"reflectance", [](Scene& s) { material(s).reflectance.g = 0.6f; }},
        Change{"texture of reflectance",
               [](Scene& s) { material(s).reflectance_texture.texture = {}; }},
        Change{"set of texture coordinates",
               [](Scene& s) { material(s).reflectance_texture.uv_set = 1; }},
        Change{"transform of texture coordinates",
               [](Scene& s) { material(s).reflectance_texture.uv_transform[2] = 0.5f; }},
        Change{"emission", [](Scene& s) { material(s).emission.b = 2.f; }},
        Change{"texture of emission", [](Scene& s) { material(s).emission_texture.texture = {}; }},
        Change{"kind of alpha", [](Scene& s) { material(s).alpha_mode = AlphaMode::blend; }},
        Change{"alpha", [](Scene& s) { material(s).alpha = 0.5f; }},
        Change{"cutoff of alpha", [](Scene& s) { material(s).alpha_cutoff = 0.4f; }},
        Change{"texture of alpha", [](Scene& s) { material(s).alpha_texture.texture = {}; }},
        Change{"transmission", [](Scene& s) { material(s).transmission = 0.5f; }},
        Change{"emission from the back", [](Scene& s) { material(s).double_sided = true; }},
        Change{"texel", [](Scene& s) { texture(s).texels[0][3] = 41; }},
        Change{"wrap along u", [](Scene& s) { texture(s).wrap_u = Wrap::clamp; }},
        Change{"wrap along v", [](Scene& s) { texture(s).wrap_v = Wrap::mirror; }},
        Change{"kind of light", [](Scene& s) { light(s).kind = Light::Kind::spot; }},
        Change{"intensity", [](Scene& s) { light(s).intensity.r = 1.f; }},
        Change{"range", [](Scene& s) { light(s).range = 2.f; }},
        Change{"inner cone", [](Scene& s) { light(s).inner_cone_angle = 0.1f; }},
        Change{"outer cone", [](Scene& s) { light(s).outer_cone_angle = 0.1f; }},
        Change{"position", [](Scene& s) { primitive(s).positions[0].x = 0.1f; }},
        Change{"normal", [](Scene& s) { primitive(s).normals[0].z = -1.f; }},
        Change{"texture coordinate", [](Scene& s) { primitive(s).uvs[0][1].x = 0.1f; }},
        Change{"triangle",
               [](Scene& s) {
                 primitive(s).triangles[0] = {0, 2, 1};
               }},
        Change{"place", [](Scene& s) { node(s).local[3][0] = 1.0; }},
        Change{"parent", [](Scene& s) { node(s).parent = {}; }},
        Change{"mesh", [](Scene& s) { node(s).mesh = MeshId(0); }},
        Change{"light of a node", [](Scene& s) { node(s).light = {}; }},
        Change{"copy", [](Scene& s) { node(s).instances[0][3][1] = 1.0; }},
        Change{"sky", [](Scene& s) { s.sky.r = 1.f; }},
        Change{"unit", [](Scene& s) { s.to_world[0][0] = 2.0; }}));

TEST(SceneDigest, DoesNotLookAtNamesCamerasAndBytesOfPictures) {
  Scene renamed = scene_of_everything();
  const std::uint64_t before = digest_of(renamed);
  material(renamed).name = texture(renamed).name = light(renamed).name = node(renamed).name = "x";
  renamed.meshes[MeshId(0)].name = "x";
  texture(renamed).encoded = {1, 2, 3};
  node(renamed).camera = renamed.cameras.push_back({});
  EXPECT_EQ(digest_of(renamed), before);
}

}  // namespace
}  // namespace halflight
