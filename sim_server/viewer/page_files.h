#pragma once
#include <span>
#include <string_view>

namespace palpate::sim {

/// A file of the page, as it is in this program.
struct PageFile {
  std::string_view path, type;  ///< "/page.js", "text/javascript; charset=utf-8"
  std::span<const char> bytes;
};

/// Returns the file that is served at this path; null: nothing.
const PageFile* page_file(std::string_view path);

}  // namespace palpate::sim
