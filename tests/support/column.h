#pragma once
#include <fmt/core.h>
#include <string>

namespace palpate::test {

/// A column of 0.1 x 0.4 x 0.1 m, one cube of six tetrahedra on the other. `tagged`: its ends, y = 0.4 and y
/// = 0, are the surfaces "top" and "bottom".
inline std::string column(bool tagged = false) {
  std::string nodes, elements, names;
  int node = 0, element = 0;
  for (int y = 0; y <= 4; ++y) {
    for (int k = 0; k < 4; ++k)
      nodes += fmt::format("{} {} {} {}\n", ++node, 0.1 * (k % 2), 0.1 * y, 0.1 * (k / 2));
  }
  // The corners of a cube: bit 0 is x, bit 1 z, 4 more is up; six ways along its edges from 0 to 7.
  const int ways[6][4] = {{0, 3, 1, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 6, 2, 7}, {0, 5, 4, 7}, {0, 4, 6, 7}};
  for (int y = 0; y < 4; ++y) {
    for (const auto& way : ways) {
      const int first = 4 * y + 1;
      elements += fmt::format("{} 4 2 0 0 {} {} {} {}\n", ++element, first + way[0], first + way[1],
                              first + way[2], first + way[3]);
    }
  }
  if (tagged) {
    names = "$PhysicalNames\n2\n2 7 \"top\"\n2 8 \"bottom\"\n$EndPhysicalNames\n";
    for (const char* triangle : {"7 7 17 18 20", "7 7 17 19 20", "8 8 1 2 4", "8 8 1 3 4"})
      elements += fmt::format("{} 2 2 {}\n", ++element, triangle);
  }
  return fmt::format(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{}$Nodes\n{}\n{}$EndNodes\n$Elements\n{}\n{}$EndElements\n",
      names, node, nodes, element, elements);
}

}  // namespace palpate::test
