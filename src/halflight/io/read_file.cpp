#include "halflight/io/read_file.h"

#include <cctype>
#include <fstream>

namespace halflight {

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

Result<Bytes> read_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    return input_error("there is no such file", path.string(), "check the name");
  if (!std::filesystem::is_regular_file(status))
    return input_error("this is not a file", path.string(), "name a scene or image file");
  std::ifstream in(path, std::ios::binary);
  const auto size = std::filesystem::file_size(path, error);
  if (!in || error)
    return input_error("the file cannot be read", path.string(), "check its rights");
  Bytes bytes(size);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (in.gcount() != static_cast<std::streamsize>(size))
    return system_error("reading ended early", path.string(), "is it still being written?");
  return bytes;
}

}  // namespace halflight
