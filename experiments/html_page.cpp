#include "experiments/html_page.h"

#include "halflight/io/read_file.h"

namespace halflight::experiments {
namespace {

constexpr std::string_view kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Halflight: the paper's figures and tables</title>
<style>
:root { color-scheme: light dark; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 70rem; margin: 2rem auto; padding: 0 1rem; }
h2 { margin-top: 3rem; border-top: 1px solid #8886; padding-top: 1rem; }
nav a { margin-right: 1rem; }
.row { display: flex; flex-wrap: wrap; gap: .75rem; margin: .5rem 0 1.5rem; }
figure { margin: 0; flex: 1 1 8rem; max-width: 16rem; }
figure img { width: 100%; image-rendering: pixelated; border: 1px solid #8886; }
figcaption { font-size: .8rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: .5rem 0 1.5rem; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .8rem; text-align: right; border-bottom: 1px solid #8884; }
th:first-child, td:first-child { text-align: left; }
.title { font-weight: 600; }
</style>
</head>
<body>
<h1>Halflight: the paper's figures and tables</h1>
<p>Paper: F. Sillion and G. Drettakis, Feature-based Control of Visibility Error, INRIA report
RR-2503, 1995.</p>
)";

std::string table_row(const std::vector<std::string>& cells, const std::string& tag) {
  std::string html = "<tr>";
  for (const std::string& cell : cells)
    html += "<" + tag + ">" + escape_html(cell) + "</" + tag + ">";
  return html + "</tr>\n";
}

struct BlockToHtml {
  const std::filesystem::path& folder;

  Result<std::string> operator()(const std::string& paragraph) const {
    return "<p>" + escape_html(paragraph) + "</p>\n";
  }

  Result<std::string> operator()(const PictureRow& row) const {
    std::string html =
        "<p class=\"title\">" + escape_html(row.title) + "</p>\n<div class=\"row\">\n";
    for (const Picture& picture : row.pictures) {
      const auto bytes = read_file(folder / (picture.file + ".png"));
      if (!bytes) return tl::unexpected(bytes.error());
      const std::string caption = escape_html(picture.caption);
      html += "<figure><img alt=\"" + caption + "\" src=\"data:image/png;base64," + base64(*bytes) +
              "\"><figcaption>" + caption + "</figcaption></figure>\n";
    }
    return html + "</div>\n";
  }

  Result<std::string> operator()(const Table& table) const {
    std::string html = "<p class=\"title\">" + escape_html(table.title) +
                       "</p>\n<div class=\"scroll\"><table>\n<thead>" +
                       table_row(table.head, "th") + "</thead>\n<tbody>\n";
    for (const auto& row : table.rows) html += table_row(row, "td");
    return html + "</tbody></table></div>\n";
  }
};

}  // namespace

std::string escape_html(std::string_view text) {
  std::string html;
  for (const char c : text) switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  return html;
}

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < have ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= have ? kDigits[group >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
}

Result<std::string> html_page(const std::filesystem::path& folder,
                              std::span<const Section> sections) {
  std::string page(kHead);
  page += "<nav>";
  for (const Section& s : sections)
    page += "<a href=\"#" + escape_html(s.name) + "\">" + escape_html(s.name) + "</a>";
  page += "</nav>\n";
  for (const Section& section : sections) {
    page += "<section id=\"" + escape_html(section.name) + "\">\n<h2>" +
            escape_html(section.title) + "</h2>\n";
    for (const Block& block : section.blocks) {
      const Result<std::string> html = std::visit(BlockToHtml{folder}, block);
      if (!html) return html;
      page += *html;
    }
    page += "</section>\n";
  }
  return page + "</body>\n</html>\n";
}

}  // namespace halflight::experiments
