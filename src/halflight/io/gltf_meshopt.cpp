#include "halflight/io/gltf_meshopt.h"

#include <meshoptimizer.h>

namespace halflight {
namespace {

void check_vertices(const JsonCursor& extension, std::size_t stride) {
  if (stride == 0 || stride > 256 || stride % 4 != 0)
    extension.fail("vertices of " + std::to_string(stride) +
                   " bytes cannot be compressed this way");
}

void check_indices(const JsonCursor& extension, std::size_t stride) {
  if (stride != 2 && stride != 4) extension.fail("indices must have 2 or 4 bytes");
}

int decode(const JsonCursor& extension, std::span<const std::uint8_t> data, std::size_t count,
           std::size_t stride, Bytes& out) {
  const std::string mode = extension.at("mode").string();
  if (mode == "ATTRIBUTES") {
    check_vertices(extension, stride);
    return meshopt_decodeVertexBuffer(out.data(), count, stride, data.data(), data.size());
  }
  check_indices(extension, stride);
  if (mode == "TRIANGLES") {
    if (count % 3 != 0) extension.fail("the number of indices is not a multiple of 3");
    return meshopt_decodeIndexBuffer(out.data(), count, stride, data.data(), data.size());
  }
  if (mode == "INDICES")
    return meshopt_decodeIndexSequence(out.data(), count, stride, data.data(), data.size());
  extension.at("mode").fail("'" + mode + "' is not a compression mode");
}

void apply_filter(const JsonCursor& extension, std::size_t count, std::size_t stride, Bytes& out) {
  const std::string filter = extension.string_or("filter", "NONE");
  const auto check = [&](bool fits) {
    if (!fits) extension.fail("the filter " + filter + " does not fit the stride");
  };
  if (filter == "OCTAHEDRAL") {
    check(stride == 4 || stride == 8);
    meshopt_decodeFilterOct(out.data(), count, stride);
  } else if (filter == "QUATERNION") {
    check(stride == 8);
    meshopt_decodeFilterQuat(out.data(), count, stride);
  } else if (filter == "EXPONENTIAL") {
    check(stride % 4 == 0);
    meshopt_decodeFilterExp(out.data(), count, stride);
  } else if (filter != "NONE") {
    extension.at("filter").fail("'" + filter + "' is not a filter");
  }
}

}  // namespace

Bytes decode_meshopt(const JsonCursor& extension, std::span<const std::uint8_t> data,
                     ReadBudget& budget) {
  const std::size_t count = extension.at("count").count();
  const std::size_t stride = extension.at("byteStride").count();
  // The format spends at least 2 bits on 16 bytes: more than that cannot be in the data.
  constexpr std::size_t kLargestRatio = 64;
  if (stride > 256) check_vertices(extension, stride);
  if (count > kMaxDecodedBytes || count * stride / kLargestRatio > data.size())
    extension.fail("the compressed data are too short for what they should hold");
  budget.take(count * stride, extension.path());
  Bytes out(count * stride);
  if (decode(extension, data, count, stride, out) != 0)
    extension.fail("the compressed data are broken");
  apply_filter(extension, count, stride, out);
  return out;
}

}  // namespace halflight
