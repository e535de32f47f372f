#include "experiments/report.h"

#include <system_error>

#include "experiments/html_page.h"
#include "experiments/markdown_page.h"
#include "halflight/io/atomic_file.h"
#include "halflight/io/image_write.h"

namespace halflight::experiments {
namespace {

Result<void> write_text(const std::filesystem::path& path, const std::string& text) {
  return write_file_atomically(path, std::as_bytes(std::span(text)));
}

Result<void> write_pictures(const std::filesystem::path& folder, const Section& section) {
  for (const Block& block : section.blocks) {
    const auto* row = std::get_if<PictureRow>(&block);
    if (!row) continue;
    for (const Picture& picture : row->pictures)
      if (auto written = write_image(folder / (picture.file + ".png"), picture.image); !written)
        return written;
  }
  return {};
}

std::string numbers_of(std::span<const Section> sections) {
  nlohmann::ordered_json all = nlohmann::ordered_json::object();
  for (const Section& section : sections) all[section.name] = section.numbers;
  return all.dump(2) + "\n";
}

}  // namespace

Result<void> write_report(const std::filesystem::path& folder, std::span<const Section> sections) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure)
    return system_error("the folder cannot be made: " + failure.message(), folder.string());
  // What cannot be written keeps nothing else from being written.
  Result<void> written;
  const auto also = [&](const Result<void>& next) {
    if (written) written = next;
  };
  for (const Section& section : sections) also(write_pictures(folder, section));
  if (const Result<std::string> html = html_page(folder, sections))
    also(write_text(folder / "report.html", *html));
  else
    also(tl::unexpected(html.error()));
  also(write_text(folder / "report.md", markdown_page(sections)));
  also(write_text(folder / "numbers.json", numbers_of(sections)));
  return written;
}

}  // namespace halflight::experiments
