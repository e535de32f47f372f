#include "experiments/markdown_page.h"

namespace halflight::experiments {
namespace {

std::string line(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += " " + cell + " |";
  return text + "\n";
}

struct AppendBlock {
  std::string& page;

  void operator()(const std::string& paragraph) const { page += paragraph + "\n\n"; }

  void operator()(const PictureRow& row) const {
    page += "**" + row.title + "**\n\n";
    std::vector<std::string> pictures, captions;
    for (const Picture& p : row.pictures) {
      pictures.push_back("![" + p.caption + "](" + p.file + ".png)");
      captions.push_back(p.caption);
    }
    page += line(captions) + line(std::vector<std::string>(captions.size(), "---")) +
            line(pictures) + "\n";
  }

  void operator()(const Table& table) const {
    page += "**" + table.title + "**\n\n" + line(table.head) +
            line(std::vector<std::string>(table.head.size(), "---"));
    for (const auto& row : table.rows) page += line(row);
    page += "\n";
  }
};

}  // namespace

std::string markdown_page(std::span<const Section> sections) {
  std::string page = "# Halflight: the paper's figures and tables\n\n";
  for (const Section& section : sections) {
    page += "## " + section.title + "\n\n";
    for (const Block& block : section.blocks) std::visit(AppendBlock{page}, block);
  }
  return page;
}

}  // namespace halflight::experiments
