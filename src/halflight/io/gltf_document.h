// The containers of a glTF scene: its JSON, its buffers and what they point to.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "halflight/io/json_cursor.h"
#include "halflight/io/read_file.h"
#include "halflight/io/scene_limits.h"

namespace halflight {

using ByteSpan = std::span<const std::uint8_t>;

// Reads buffers when they are asked for and keeps them. All members throw ReadFailure.
class GltfDocument {
 public:
  GltfDocument(Bytes file, std::filesystem::path path);

  JsonCursor root() const { return {json_, path_.string()}; }
  // The i-th element of a top-level array ("accessors"), where `from` is the index of it.
  JsonCursor element(std::string_view array, const JsonCursor& from) const;

  // The bytes of a buffer view, inside its buffer; decompressed when EXT_meshopt_compression.
  ByteSpan buffer_view(const JsonCursor& index);
  // byteStride of the view; 0 when its elements lie packed.
  std::size_t stride(const JsonCursor& view_index) const;
  // The content of a data URI or of a file beside the scene, which is read once however often it
  // is named. `where` is the path of the URI.
  Result<ByteSpan> resolve_uri(const std::string& uri, const std::string& where);

 private:
  void split_glb();
  void parse_json(ByteSpan text);
  void check_version() const;
  ByteSpan buffer(const JsonCursor& index);
  ByteSpan part_of_buffer(const JsonCursor& view);
  Result<ByteSpan> keep(const std::string& name, Result<Bytes> bytes);

  std::filesystem::path path_;
  Bytes file_;
  ByteSpan binary_chunk_;
  bool has_binary_chunk_ = false;
  nlohmann::json json_;
  std::map<std::string, Bytes> resources_;     // by file, or by the place of a data URI
  std::map<std::size_t, ByteSpan> buffers_;    // those that are not the binary chunk
  std::map<std::size_t, Bytes> decompressed_;  // by buffer view
  ReadBudget decoded_bytes_{"bytes of compressed geometry", kMaxDecodedBytes};
};

}  // namespace halflight
