#include "command_files.h"

#include <system_error>

#include <fmt/format.h>

#include "halflight/io/atomic_file.h"
#include "halflight/io/files_of_scene.h"

namespace halflight::app {
namespace {

namespace fs = std::filesystem;

bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code unknown;
  if (fs::equivalent(a, b, unknown)) return true;
  const fs::path whole_a = fs::weakly_canonical(fs::absolute(a, unknown), unknown);
  if (unknown) return a.lexically_normal() == b.lexically_normal();
  const fs::path whole_b = fs::weakly_canonical(fs::absolute(b, unknown), unknown);
  return !unknown && whole_a == whole_b;
}

}  // namespace

void CommandFiles::reads(std::string role, const fs::path& path) {
  if (!path.empty()) inputs.push_back({std::move(role), path});
}

void CommandFiles::writes(std::string role, const fs::path& path) {
  if (!path.empty()) outputs.push_back({std::move(role), path});
}

void CommandFiles::reads_view(std::string role, const std::string& view) {
  if (view.ends_with(".json")) reads(std::move(role), view);
}

void CommandFiles::reads_scene(const fs::path& path) {
  reads("the scene", path);
  for (const fs::path& file : files_of_scene(path)) reads("a file of the scene", file);
}

Result<void> check(const CommandFiles& files) {
  const auto& outputs = files.outputs;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const NamedFile& output = outputs[i];
    if (is_written_in_place(output.path)) continue;
    for (const NamedFile& input : files.inputs)
      if (is_same_file(output.path, input.path))
        return input_error(fmt::format("{} would replace {}", output.role, input.role),
                           output.path.string(), "write to another file");
    for (std::size_t k = 0; k < i; ++k)
      if (is_same_file(output.path, outputs[k].path))
        return input_error(
            fmt::format("{} would replace what {} writes", output.role, outputs[k].role),
            output.path.string(), "give each output a name of its own");
  }
  for (const NamedFile& output : outputs)
    if (auto ok = check_writable(output.path); !ok) return ok;
  return {};
}

CLI::Validator file_name() {
  return CLI::Validator(
      [](const std::string& text) {
        return text.empty()
                   ? std::string("'' is no name of a file: give one, or leave the option out")
                   : std::string();
      },
      "");
}

}  // namespace halflight::app
