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

// One value per point; normalized integers become fractions of their largest value. Whether they
// are is for the accessor to say: Draco's decoder takes any byte of its data for a bool.
template <class Vector>
std::vector<Vector> read_attribute(draco::Mesh& mesh, const JsonCursor& id, bool normalized) {
  const int index = mesh.GetAttributeIdByUniqueId(
      static_cast<std::uint32_t>(id.index_below(1u << 31, "attribute")));
  if (index < 0) id.fail("the Draco data have no such attribute");
  draco::PointAttribute* attribute = mesh.attribute(index);
  attribute->set_normalized(normalized);
  constexpr int kComponents = Vector::length();
  if (attribute->num_components() != kComponents)
    id.fail("the attribute should have " + std::to_string(kComponents) + " components");
  std::vector<Vector> values(mesh.num_points());
  for (draco::PointIndex i(0); i < mesh.num_points(); ++i) {
    const draco::AttributeValueIndex value = attribute->mapped_index(i);
    if (value.value() >= attribute->size() ||
        !attribute->ConvertValue<float, kComponents>(value, &values[i.value()][0]))
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
  const auto normalized = [&](std::string_view name) {
    const auto accessor = json.at("attributes").find(name);
    return accessor && document.element("accessors", *accessor).boolean_or("normalized", false);
  };
  const auto read = [&]<class Vector>(std::string_view name, std::vector<Vector>& to) {
    if (const auto id = ids.find(name)) to = read_attribute<Vector>(*mesh, *id, normalized(name));
  };
  p.positions = read_attribute<Vec3>(*mesh, ids.at("POSITION"), normalized("POSITION"));
  read("NORMAL", p.normals);
  read("TEXCOORD_0", p.uvs[0]);
  read("TEXCOORD_1", p.uvs[1]);
  p.triangles.resize(mesh->num_faces());
  for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t point = mesh->face(f)[static_cast<std::size_t>(k)].value();
      if (point >= mesh->num_points()) extension.fail("the Draco triangles are broken");
      p.triangles[f.value()][static_cast<std::size_t>(k)] = point;
    }
}

}  // namespace halflight
