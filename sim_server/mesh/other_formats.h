#pragma once
#include <filesystem>
#include <string_view>

namespace palpate::sim {

/// Throws `Error` that says what a file that is no Gmsh mesh of today is, and how to make one of it: a volume
/// mesh is converted; a surface without an inside must first be filled with tetrahedra. `bytes`: all of the
/// file.
[[noreturn]] void fail_other_format(const std::filesystem::path& file, std::string_view bytes);

}  // namespace palpate::sim
