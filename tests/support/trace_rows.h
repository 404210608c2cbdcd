#pragma once
/// The trace that `haptic_client run --trace` leaves.
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace palpate::test {

struct TraceRow {
  double t = 0;               ///< s
  std::array<double, 3> f{};  ///< N, device frame
  double newton() const { return std::hypot(f[0], f[1], f[2]); }
};

inline std::vector<TraceRow> read_trace(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);  // the names
  std::vector<TraceRow> rows;
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    std::array<double, 8> number{};
    for (double& each : number) {
      std::string cell;
      std::getline(cells, cell, ',');
      each = std::stod(cell);
    }
    rows.push_back({number[1], {number[5], number[6], number[7]}});
  }
  return rows;
}

}  // namespace palpate::test
