#include "sim_server/mesh/other_formats.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>
#include <string>

#include "common/error.h"
#include "sim_server/mesh/cursor.h"

namespace palpate::sim {
namespace {

// Cells of VTK with no inside: points, lines, triangles, polygons and their curved kinds (vtkCellType.h).
constexpr std::array kFlatCells{1, 2, 3, 4, 5, 6, 7, 8, 9, 21, 22, 23, 28, 30, 34, 35, 36, 68, 69, 70};
constexpr std::size_t kHeader = 4096;  // bytes: in which a VTK file says what it holds

bool has_inside(int cell) {
  return std::ranges::find(kFlatCells, cell) == kFlatCells.end();
}

/// The text behind `key` at the beginning of a line, or of all; nothing where there is no such line.
std::optional<std::string_view> text_after(std::string_view text, std::string_view key) {
  for (std::size_t at = text.find(key); at != std::string_view::npos; at = text.find(key, at + 1)) {
    if (at == 0 || text[at - 1] == '\n') return text.substr(at + key.size());
  }
  return {};
}

/// The whole number that `text` begins with after white space, which goes with it.
std::optional<int> take_number(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return {};
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

/// True if all types of cells in a list are known, and none has an inside: `count` of them, or all there are.
bool are_flat(std::string_view list, std::optional<int> count) {
  int read = 0;
  for (; !count || read < *count; ++read) {
    const auto cell = take_number(list);
    if (!cell) break;
    if (has_inside(*cell)) return false;
  }
  return read > 0 && read == count.value_or(read);
}

/// The same of 32-bit integers, the highest byte first, as VTK writes them.
bool are_flat_bytes(std::string_view bytes, std::size_t count) {
  if (bytes.size() / 4 < count) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view three = bytes.substr(4 * i, 3);
    if (three.find_first_not_of('\0') != std::string_view::npos) return false;
    if (has_inside(static_cast<unsigned char>(bytes[4 * i + 3]))) return false;
  }
  return count > 0;
}

bool is_legacy_vtk(std::string_view bytes) {
  return bytes.starts_with("# vtk DataFile");
}

/// True for a surface of the legacy format: text or big-endian bytes under keywords.
bool is_legacy_surface(std::string_view bytes) {
  const auto set = text_after(bytes.substr(0, kHeader), "DATASET ");
  if (!set) return false;
  if (set->starts_with("POLYDATA")) return true;
  auto types = text_after(bytes, "CELL_TYPES ");
  if (!types) return false;
  const auto count = take_number(*types);
  const std::size_t line = types->find('\n');
  if (!count || *count < 0 || line == std::string_view::npos) return false;
  types->remove_prefix(line + 1);
  const bool binary = text_after(bytes.substr(0, kHeader), "BINARY").has_value();
  return binary ? are_flat_bytes(*types, static_cast<std::size_t>(*count)) : are_flat(*types, *count);
}

/// True for a surface of the XML format: what it calls itself, and types of cells that are written as text.
bool is_xml_surface(std::string_view bytes) {
  if (bytes.substr(0, kHeader).find("type=\"PolyData\"") != std::string_view::npos) return true;
  const std::size_t name = bytes.find("Name=\"types\"");
  if (name == std::string_view::npos) return false;
  const std::size_t begin = bytes.find('>', name);
  if (begin == std::string_view::npos) return false;
  const std::string_view tag = bytes.substr(name, begin - name);
  return tag.find("format=\"ascii\"") != std::string_view::npos && are_flat(bytes.substr(begin + 1), {});
}

bool is_vtk_surface(std::string_view bytes) {
  if (is_legacy_vtk(bytes)) return is_legacy_surface(bytes);
  return bytes.substr(0, kHeader).find("<VTKFile") != std::string_view::npos && is_xml_surface(bytes);
}

/// A file that Gmsh fills, and what makes it of this one: tried with Gmsh 4.8 and meshio 5.
struct Filling {
  std::string file, before;
};

Filling filling_of(const std::string& path, const std::string& extension, std::string_view bytes) {
  if (extension == ".stl") return {path, ""};
  const bool vtk = is_legacy_vtk(bytes) || extension == ".vtp" || extension == ".vtu";
  if (is_legacy_vtk(bytes) && bytes.find("Version 5") > bytes.find('\n')) return {path, ""};
  const bool poly_data = vtk && bytes.find("CELL_TYPES") == std::string_view::npos && extension != ".vtu";
  if (poly_data) return {"OUT.stl", "save it as OUT.stl (ParaView: Save Data), then "};
  return {"OUT.stl", fmt::format("`meshio convert \"{}\" OUT.stl`, then ", path)};
}

/// The surface is meshed anew on the way, so that one with poor triangles or small crossings is filled too.
[[noreturn]] void fail_surface(const std::string& path, const std::string& kind, const Filling& filling) {
  fail(
      "{}: {}, a surface without an inside; fill it with tetrahedra by a volume mesher, as Gmsh: {}`echo "
      "'Merge "
      "\"{}\"; ClassifySurfaces{{Pi, 1, 1, Pi}}; CreateGeometry; Surface Loop(1) = Surface{{:}}; Volume(1) = "
      "{{1}};' > fill.geo && gmsh -3 -clmax EDGE_LENGTH fill.geo -o OUT.msh`",
      path, kind, filling.before, filling.file);
}

}  // namespace

void fail_other_format(const std::filesystem::path& file, std::string_view bytes) {
  const std::string path = file.string();
  if (bytes.empty()) fail("{}: an empty file, not a mesh", path);
  if (bytes.starts_with("$NOD")) {
    fail("{}: a Gmsh MSH 1 file; 2.2 and 4.1 are read; {}", path, gmsh_command(path));
  }
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".toml")
    fail("{}: a file of settings, not a mesh; a scene names its mesh in [mesh] file", path);
  const std::string kind = extension.empty() || extension == ".msh" ? "no known format" : extension + " file";
  const bool surface = extension == ".obj" || extension == ".stl" || extension == ".ply" ||
                       extension == ".off" || is_vtk_surface(bytes);
  if (surface) fail_surface(path, kind, filling_of(path, extension, bytes));
  // gmsh22, as meshio writes 4.1 only for elements of a single type.
  fail(
      "{}: {}, not a Gmsh mesh (no $MeshFormat at the start); convert it: "
      "`meshio convert \"{}\" OUT.msh --output-format gmsh22`",
      path, kind, path);
}

}  // namespace palpate::sim
