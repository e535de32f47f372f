// Meshes compressed by the encoders of Draco and meshoptimizer come back as they were.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "gltf_builder.h"
#include "halflight/io/load_scene.h"
#include "halflight/scene/geometry.h"
#include "temporary_folder.h"

namespace halflight {
namespace {

constexpr std::size_t kSide = 20;

float height(std::size_t x, std::size_t y) {
  return 0.25f * static_cast<float>((x * x + 3 * y) % 5);
}
Vec3 grid_point(std::size_t x, std::size_t y) {
  return {static_cast<float>(x), static_cast<float>(y), height(x, y)};
}
std::vector<Vec3> grid_positions() {
  std::vector<Vec3> positions;
  for (std::size_t y = 0; y <= kSide; ++y)
    for (std::size_t x = 0; x <= kSide; ++x) positions.push_back(grid_point(x, y));
  return positions;
}
std::vector<std::uint32_t> grid_indices() {
  std::vector<std::uint32_t> indices;
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const std::uint32_t row = kSide + 1, a = y * row + x;
      for (const std::uint32_t i : {a, a + 1, a + row, a + 1, a + row + 1, a + row})
        indices.push_back(i);
    }
  return indices;
}

float area(const std::vector<Vec3>& positions, const std::vector<std::uint32_t>& indices) {
  float sum = 0.f;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    const Vec3 a = positions[indices[i]];
    sum += 0.5f *
           glm::length(glm::cross(positions[indices[i + 1]] - a, positions[indices[i + 2]] - a));
  }
  return sum;
}
float area(const Geometry& g) {
  float sum = 0.f;
  for (std::size_t i = 0; i < g.triangles.size(); ++i)
    sum += 0.5f * glm::length(g.scaled_normal(TriangleId(i)));
  return sum;
}

Result<Scene> load(const GltfBuilder& gltf) {
  const TemporaryFolder folder;
  return load_scene(folder.write("scene.glb", gltf.glb()));
}

void expect_grid(const Result<Scene>& scene) {
  ASSERT_TRUE(scene) << scene.error().line();
  const Geometry g = flatten(*scene);
  EXPECT_EQ(g.triangles.size(), 2 * kSide * kSide);
  const float expected = area(grid_positions(), grid_indices());
  EXPECT_NEAR(area(g), expected, 2e-4f * expected);  // Draco quantizes to 16 bits
  for (std::size_t i = 0; i < g.triangles.size(); ++i)
    EXPECT_GT(g.scaled_normal(TriangleId(i)).z, 0.f);
}

std::vector<std::uint8_t> draco_bytes() {
  const std::vector<Vec3> positions = grid_positions();
  const std::vector<std::uint32_t> indices = grid_indices();
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(indices.size() / 3));
  const int id = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (std::size_t i = 0; i < indices.size(); i += 3)
    builder.SetAttributeValuesForFace(id, draco::FaceIndex(static_cast<std::uint32_t>(i / 3)),
                                      &positions[indices[i]], &positions[indices[i + 1]],
                                      &positions[indices[i + 2]]);
  draco::Encoder encoder;
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 16);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*builder.Finalize(), &buffer).ok());
  return {buffer.data(), buffer.data() + buffer.size()};
}

GltfBuilder draco_scene(const std::vector<std::uint8_t>& bytes) {
  GltfBuilder gltf;
  const auto view = gltf.add_view(bytes);
  const auto position =
      gltf.add("accessors",
               {{"componentType", 5126}, {"type", "VEC3"}, {"count", (kSide + 1) * (kSide + 1)}});
  nlohmann::json primitive = {{"attributes", {{"POSITION", position}}}};
  primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", view},
                                                           {"attributes", {{"POSITION", 0}}}};
  gltf.add_root({{"mesh", gltf.add_mesh(primitive)}});
  gltf.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return gltf;
}

TEST(GltfCompression, DracoMeshesComeBack) { expect_grid(load(draco_scene(draco_bytes()))); }

TEST(GltfCompression, BrokenDracoDataAreRefused) {
  std::vector<std::uint8_t> bytes = draco_bytes();
  bytes.resize(bytes.size() / 2);
  const Result<Scene> scene = load(draco_scene(bytes));
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().where, testing::HasSubstr("KHR_draco_mesh_compression"));
}

nlohmann::json compressed_view(GltfBuilder& gltf, const std::vector<std::uint8_t>& bytes,
                               std::size_t stride, std::size_t count, const char* mode) {
  const auto raw = gltf.add_view(bytes);
  nlohmann::json extension = gltf.json["bufferViews"][raw];
  extension["byteStride"] = stride;
  extension["count"] = count;
  extension["mode"] = mode;
  // The plain buffer is a placeholder that holds nothing.
  nlohmann::json view = {{"buffer", 1}, {"byteLength", stride * count}};
  view["extensions"]["EXT_meshopt_compression"] = extension;
  return view;
}

GltfBuilder meshopt_scene() {
  const std::vector<Vec3> positions = grid_positions();
  const std::vector<std::uint32_t> indices = grid_indices();
  std::vector<std::uint8_t> vertex_bytes(
      meshopt_encodeVertexBufferBound(positions.size(), sizeof(Vec3)));
  vertex_bytes.resize(meshopt_encodeVertexBuffer(vertex_bytes.data(), vertex_bytes.size(),
                                                 positions.data(), positions.size(), sizeof(Vec3)));
  std::vector<std::uint8_t> index_bytes(
      meshopt_encodeIndexBufferBound(indices.size(), positions.size()));
  index_bytes.resize(meshopt_encodeIndexBuffer(index_bytes.data(), index_bytes.size(),
                                               indices.data(), indices.size()));
  GltfBuilder gltf;
  const auto vertex_view = gltf.add("bufferViews", compressed_view(gltf, vertex_bytes, sizeof(Vec3),
                                                                   positions.size(), "ATTRIBUTES"));
  const auto index_view =
      gltf.add("bufferViews", compressed_view(gltf, index_bytes, 4, indices.size(), "TRIANGLES"));
  const auto position = gltf.add("accessors", {{"bufferView", vertex_view},
                                               {"componentType", 5126},
                                               {"type", "VEC3"},
                                               {"count", positions.size()}});
  const auto index = gltf.add("accessors", {{"bufferView", index_view},
                                            {"componentType", 5125},
                                            {"type", "SCALAR"},
                                            {"count", indices.size()}});
  gltf.add_root(
      {{"mesh", gltf.add_mesh({{"attributes", {{"POSITION", position}}}, {"indices", index}})}});
  gltf.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  gltf.json["buffers"] = {{{"byteLength", gltf.data().size()}}, {{"byteLength", 1 << 20}}};
  return gltf;
}

TEST(GltfCompression, MeshoptBuffersComeBack) { expect_grid(load(meshopt_scene())); }

TEST(GltfCompression, MeshoptClaimsThatTheDataCannotHoldAreRefused) {
  GltfBuilder gltf = meshopt_scene();
  for (auto& view : gltf.json["bufferViews"])
    if (view.contains("extensions"))
      view["extensions"]["EXT_meshopt_compression"]["count"] = 3000000000u;
  const Result<Scene> scene = load(gltf);
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().what, testing::HasSubstr("too short"));
}

}  // namespace
}  // namespace halflight
