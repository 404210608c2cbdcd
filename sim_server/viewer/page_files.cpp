/// The files of page/dist are put in by the assembler, as they are.
#include "sim_server/viewer/page_files.h"

#include <algorithm>
#include <array>

// clang-format off
#define PALPATE_PUT_IN(name, file)                                   \
  asm(".pushsection .rodata\n"                                       \
      ".global palpate_page_" #name "\n"                             \
      "palpate_page_" #name ":\n"                                    \
      ".incbin \"" PALPATE_PAGE_DIR "/" file "\"\n"                  \
      ".global palpate_page_" #name "_end\n"                         \
      "palpate_page_" #name "_end:\n"                                \
      ".byte 0\n"                                                    \
      ".popsection\n");                                              \
  extern "C" const char palpate_page_##name[], palpate_page_##name##_end[]
// clang-format on

PALPATE_PUT_IN(html, "index.html");
PALPATE_PUT_IN(js, "page.js");
PALPATE_PUT_IN(css, "page.css");

namespace palpate::sim {

const PageFile* page_file(std::string_view path) {
  static const std::array<PageFile, 4> files{{
      {"/", "text/html; charset=utf-8", {palpate_page_html, palpate_page_html_end}},
      {"/index.html", "text/html; charset=utf-8", {palpate_page_html, palpate_page_html_end}},
      {"/page.js", "text/javascript; charset=utf-8", {palpate_page_js, palpate_page_js_end}},
      {"/page.css", "text/css; charset=utf-8", {palpate_page_css, palpate_page_css_end}},
  }};
  const auto found = std::ranges::find(files, path, &PageFile::path);
  return found == files.end() ? nullptr : &*found;
}

}  // namespace palpate::sim
