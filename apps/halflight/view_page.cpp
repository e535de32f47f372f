#include "view_page.h"

#include <string_view>

// Bytes of a file between two symbols; a zero behind them keeps the second one its own.
#define HALFLIGHT_EMBED(name, file)                                    \
  __asm__(                                                             \
      ".pushsection .rodata\n"                                         \
      ".global halflight_" #name "_begin\n.global halflight_" #name    \
      "_end\n"                                                         \
      "halflight_" #name "_begin:\n.incbin \"" HALFLIGHT_PAGE "/" file \
      "\"\n"                                                           \
      "halflight_" #name "_end:\n.byte 0\n.popsection\n");             \
  extern "C" const char halflight_##name##_begin[];                    \
  extern "C" const char halflight_##name##_end[]

HALFLIGHT_EMBED(page_html, "index.html");
HALFLIGHT_EMBED(page_js, "app.js");
HALFLIGHT_EMBED(page_css, "app.css");

namespace halflight::app {

PageFiles view_page() {
  const auto between = [](const char* first, const char* last) {
    return std::string_view(first, static_cast<std::size_t>(last - first));
  };
  return {
      {"",
       {"text/html; charset=utf-8", between(halflight_page_html_begin, halflight_page_html_end)}},
      {"app.js",
       {"text/javascript; charset=utf-8", between(halflight_page_js_begin, halflight_page_js_end)}},
      {"app.css",
       {"text/css; charset=utf-8", between(halflight_page_css_begin, halflight_page_css_end)}}};
}

}  // namespace halflight::app
