#include "sim_server/mesh/other_formats.h"

#include <string>

#include "common/error.h"
#include "tests/support/catch.h"

namespace palpate::sim {
namespace {

std::string error_of(const std::string& bytes, const std::string& file) {
  try {
    fail_other_format(file, bytes);
  } catch (const Error& error) {
    CHECK(error.exit_code() == 2);
    return error.what();
  }
}

TEST_CASE("a VTK file is converted, or filled where it holds a surface only", "[mesh]") {
  const std::string head = "# vtk DataFile Version 3.0\nliver\nASCII\nDATASET ",
                    points = "POINTS 3 float\n1 2 3\n";
  const auto is_filled = [&](const std::string& text, const std::string& name = "a.vtk") {
    const std::string said = error_of(text, name);
    CAPTURE(said);
    const bool filled = said.find("file, a surface without an inside; fill it") != std::string::npos;
    CHECK(filled == (said.find("gmsh -3 -clmax EDGE_LENGTH fill.geo -o OUT.msh") != std::string::npos));
    CHECK(filled != (said.find("--output-format gmsh22") != std::string::npos));
    return filled;
  };
  CHECK(is_filled(head + "POLYDATA\n" + points));
  CHECK(is_filled(head + "UNSTRUCTURED_GRID\n" + points + "CELLS 2 8\nCELL_TYPES 2\n5\n5\n"));
  CHECK_FALSE(is_filled(head + "UNSTRUCTURED_GRID\n" + points + "CELLS 2 9\nCELL_TYPES 2\n5\n10\n"));
  CHECK_FALSE(is_filled(head + "UNSTRUCTURED_GRID\n" + points + "CELL_TYPES 0\n"));
  CHECK_FALSE(is_filled(head + "UNSTRUCTURED_GRID\n" + points));
  const std::string binary =
      "# vtk DataFile Version 4.2\nliver\nBINARY\nDATASET UNSTRUCTURED_GRID\nCELL_TYPES 2\n";
  CHECK(is_filled(binary + std::string("\0\0\0\5\0\0\0\5", 8)));
  CHECK_FALSE(is_filled(binary + std::string("\0\0\0\5\0\0\0\12", 8)));
  CHECK_FALSE(is_filled(binary + std::string("\0\0\0\5", 4)));
  CHECK(is_filled("<VTKFile type=\"PolyData\">", "a.vtp"));
  const std::string types =
      "<VTKFile type=\"UnstructuredGrid\"><DataArray type=\"UInt8\" Name=\"types\" format=";
  CHECK(is_filled(types + "\"ascii\">\n5 5\n</DataArray>", "a.vtu"));
  CHECK_FALSE(is_filled(types + "\"ascii\">\n5 10\n</DataArray>", "a.vtu"));
  CHECK_FALSE(is_filled(types + "\"binary\">\n5 5\n</DataArray>", "a.vtu"));
}

}  // namespace
}  // namespace palpate::sim
