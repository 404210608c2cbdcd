#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/types.h"

namespace palpate::sim {

/// Numbers at each point or in each cell.
struct VtuArray {
  std::string name;
  int components;  ///< 1, 3 or 9 (row by row)
  std::vector<double> values;
};

/// An unstructured grid for ParaView: a VTK XML file (.vtu), binary. `cells`: points of each cell one after
/// the other, 4 (linear tetrahedra) or 10 (quadratic, corners before the middles of the edges 01, 12, 02, 03,
/// 13, 23). Appears whole or not at all; throws `Error`.
void write_vtu(const std::filesystem::path& file, std::span<const Vec3> points, std::span<const int> cells,
               int points_per_cell, const std::vector<VtuArray>& at_points,
               const std::vector<VtuArray>& in_cells);

/// A time series of such files, for ParaView (.pvd); each name as seen from the folder of `file`.
void write_pvd(const std::filesystem::path& file,
               const std::vector<std::pair<double, std::filesystem::path>>& at_times);

}  // namespace palpate::sim
