#include "halflight/io/gltf_draco.h"

#include <draco/compression/decode.h>

namespace halflight {
namespace {

std::unique_ptr<draco::Mesh> decode(ByteSpan data, const JsonCursor& extension) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(data.data()), data.size());
  draco::Decoder decoder;
  auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
  if (!mesh.ok())
    extension.fail(std::string("the Draco data are broken: ") + mesh.status().error_msg());
  const std::size_t points = (*mesh.value()).num_points();
  if (points > kMaxVertices || mesh.value()->num_faces() > kMaxTriangles)
    extension.fail("the Draco mesh is too large", "simplify or split the scene");
  return std::move(mesh).value();
}

// One value per point; normalized integers become fractions of their largest value.
template <class Vector, int N>
std::vector<Vector> read_attribute(const draco::Mesh& mesh, const JsonCursor& id) {
  const auto* attribute = mesh.GetAttributeByUniqueId(
      static_cast<std::uint32_t>(id.index_below(1u << 31, "attribute")));
  if (!attribute) id.fail("the Draco data have no such attribute");
  // glTF has none, and Draco's reader takes any byte for one.
  if (attribute->data_type() == draco::DT_BOOL) id.fail("the attribute holds no numbers");
  if (attribute->num_components() != N)
    id.fail("the attribute should have " + std::to_string(N) + " components");
  std::vector<Vector> values(mesh.num_points());
  for (draco::PointIndex i(0); i < mesh.num_points(); ++i) {
    const draco::AttributeValueIndex value = attribute->mapped_index(i);
    if (value.value() >= attribute->size() ||
        !attribute->ConvertValue<float, N>(value, &values[i.value()][0]))
      id.fail("the Draco attribute is broken");
  }
  return values;
}

}  // namespace

void read_draco(GltfDocument& document, const JsonCursor& json, const JsonCursor& extension,
                Primitive& p) {
  if (json.count_or("mode", 4) < 4 || json.count_or("mode", 4) > 5)
    json.at("mode").fail("Draco meshes hold triangles");
  const ByteSpan data = document.buffer_view(extension.at("bufferView"));
  const std::unique_ptr<draco::Mesh> mesh = decode(data, extension);
  const JsonCursor ids = extension.at("attributes");
  p.positions = read_attribute<Vec3, 3>(*mesh, ids.at("POSITION"));
  if (const auto id = ids.find("NORMAL")) p.normals = read_attribute<Vec3, 3>(*mesh, *id);
  if (const auto id = ids.find("TEXCOORD_0")) p.uvs[0] = read_attribute<Vec2, 2>(*mesh, *id);
  if (const auto id = ids.find("TEXCOORD_1")) p.uvs[1] = read_attribute<Vec2, 2>(*mesh, *id);
  p.triangles.resize(mesh->num_faces());
  for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t point = mesh->face(f)[static_cast<std::size_t>(k)].value();
      if (point >= mesh->num_points()) extension.fail("the Draco triangles are broken");
      p.triangles[f.value()][static_cast<std::size_t>(k)] = point;
    }
}

}  // namespace halflight
