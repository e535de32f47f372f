#include "halflight/io/gltf_document.h"

#include <cstring>

#include "halflight/io/data_uri.h"
#include "halflight/io/gltf_extensions.h"
#include "halflight/io/gltf_meshopt.h"

namespace halflight {
namespace {

constexpr std::uint32_t kGlbMagic = 0x46546c67;  // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4e4f534a;
constexpr std::uint32_t kBinaryChunk = 0x004e4942;

// Little-endian, as this machine is.
std::uint32_t word_at(ByteSpan bytes, std::size_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + offset, sizeof word);
  return word;
}

bool is_glb(ByteSpan bytes, const std::filesystem::path& path) {
  return lower_case_extension(path) == ".glb" ||
         (bytes.size() >= 4 && word_at(bytes, 0) == kGlbMagic);
}

}  // namespace

GltfDocument::GltfDocument(Bytes file, std::filesystem::path path)
    : path_(std::move(path)), file_(std::move(file)) {
  if (is_glb(file_, path_))
    split_glb();
  else
    parse_json(file_);
  check_version();
  check_required_extensions(root());
}

void GltfDocument::split_glb() {
  const auto fail = [&](const std::string& what) {
    fail_reading("the GLB container is broken: " + what, path_.string(), "export the scene again");
  };
  if (file_.size() < 12) fail("it ends inside its header");
  if (word_at(file_, 0) != kGlbMagic) fail("it does not begin with 'glTF'");
  if (word_at(file_, 4) != 2) fail("its version is not 2");
  if (word_at(file_, 8) > file_.size()) fail("it is shorter than its header says");
  const ByteSpan all = ByteSpan(file_).first(word_at(file_, 8));
  ByteSpan json;
  for (std::size_t at = 12, chunk = 0; at < all.size(); ++chunk) {
    if (all.size() - at < 8) fail("it ends inside the header of a chunk");
    const std::size_t length = word_at(all, at);
    const std::uint32_t kind = word_at(all, at + 4);
    at += 8;
    if (length > all.size() - at) fail("it ends inside a chunk");
    if (chunk == 0 && kind == kJsonChunk) json = all.subspan(at, length);
    if (chunk == 1 && kind == kBinaryChunk) {
      binary_chunk_ = all.subspan(at, length);
      has_binary_chunk_ = true;
    }
    at += length;
  }
  if (json.empty()) fail("its first chunk is not JSON");
  parse_json(json);
}

void GltfDocument::parse_json(ByteSpan text) {
  try {
    json_ = nlohmann::json::parse(text.begin(), text.end());
  } catch (const nlohmann::json::exception& e) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: ..."
    std::string reason = e.what();
    reason = reason.substr(std::min(reason.find("] ") + 2, reason.size()));
    fail_reading("this is not valid JSON: " + reason, path_.string(), "export the scene again");
  }
}

void GltfDocument::check_version() const {
  const JsonCursor asset = root().at("asset");
  const JsonCursor version = asset.at("version");
  const auto readable = [](const std::string& v) { return v.starts_with("2."); };
  if (!readable(version.string()))
    version.fail("glTF version " + version.string() + " cannot be read", "convert it to glTF 2.0");
  if (const auto least = asset.find("minVersion"); least && least->string() != "2.0")
    least->fail("the scene needs glTF version " + least->string(), "convert it to glTF 2.0");
}

JsonCursor GltfDocument::element(std::string_view array, const JsonCursor& from) const {
  const auto elements = root().find(array);
  const std::size_t n = elements ? elements->size() : 0;
  const std::size_t index = from.index_below(n, array);
  return (*elements)[index];
}

Result<ByteSpan> GltfDocument::resolve_uri(const std::string& uri, const std::string& where) {
  if (uri.starts_with("data:")) return keep(where, decode_data_uri(uri, where));
  if (uri.find("://") != std::string::npos)
    return input_error("'" + uri + "' is not a file", where, "save the scene with its files");
  const std::filesystem::path file = path_.parent_path() / percent_decoded(uri);
  std::error_code missing;
  const std::string one_name = std::filesystem::canonical(file, missing).string();
  if (const auto known = resources_.find(one_name); !missing && known != resources_.end())
    return known->second;
  return keep(one_name, read_file(file).map_error([&](Error error) {
    error.what += ", named by " + where;
    return error;
  }));
}

Result<ByteSpan> GltfDocument::keep(const std::string& name, Result<Bytes> bytes) {
  return bytes.map([&](Bytes& content) {
    return ByteSpan(resources_.insert_or_assign(name, std::move(content)).first->second);
  });
}

ByteSpan GltfDocument::buffer(const JsonCursor& index) {
  const JsonCursor json = element("buffers", index);
  const std::size_t length = json.at("byteLength").count();
  ByteSpan bytes;
  if (const auto uri = json.find("uri")) {
    const auto [entry, added] = buffers_.try_emplace(index.count());
    if (added) entry->second = value_or_fail(resolve_uri(uri->string(), uri->path()));
    bytes = entry->second;
  } else if (index.count() == 0 && has_binary_chunk_) {
    bytes = binary_chunk_;
  } else {
    json.fail("the buffer has neither a uri nor a GLB chunk");
  }
  if (length > bytes.size())
    json.fail("the buffer should have " + std::to_string(length) + " bytes, but has " +
              std::to_string(bytes.size()));
  return bytes.first(length);
}

ByteSpan GltfDocument::part_of_buffer(const JsonCursor& view) {
  const ByteSpan bytes = buffer(view.at("buffer"));
  const std::size_t offset = view.count_or("byteOffset", 0);
  const std::size_t length = view.at("byteLength").count();
  if (offset > bytes.size() || length > bytes.size() - offset)
    view.fail("the buffer view reaches beyond its buffer");
  return bytes.subspan(offset, length);
}

ByteSpan GltfDocument::buffer_view(const JsonCursor& index) {
  const JsonCursor view = element("bufferViews", index);
  const auto meshopt = view.extension("EXT_meshopt_compression");
  if (!meshopt) return part_of_buffer(view);
  const auto [entry, added] = decompressed_.try_emplace(index.count());
  if (added) entry->second = decode_meshopt(*meshopt, part_of_buffer(*meshopt), decoded_bytes_);
  return entry->second;
}

std::size_t GltfDocument::stride(const JsonCursor& view_index) const {
  return element("bufferViews", view_index).count_or("byteStride", 0);
}

}  // namespace halflight
