#include "sim_server/mesh/vtu_output.h"

#include <cstdint>
#include <fmt/core.h>
#include <fstream>
#include <numeric>

#include "common/error.h"
#include "common/report.h"

namespace palpate::sim {
namespace {

enum VtkCell : std::uint8_t { kVtkTetrahedron = 10, kVtkQuadraticTetrahedron = 24 };

/// Arrays that stand at the end of the file, each after its size.
class Appended {
 public:
  template <class Value>
  std::string add(const char* type, const std::string& name, int components, std::span<const Value> values) {
    const std::string element = fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        type, name, components, bytes_.size());
    const std::uint64_t size = values.size_bytes();
    append(&size, sizeof(size));
    append(values.data(), values.size_bytes());
    return element;
  }
  std::string add(const std::vector<VtuArray>& arrays) {
    std::string elements;
    for (const VtuArray& a : arrays)
      elements += add("Float64", a.name, a.components, std::span<const double>(a.values));
    return elements;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  void append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  std::string bytes_;
};

void write_atomically(const std::filesystem::path& file, const std::string& content) {
  AtomicFile writer(file, Contents::kShapes);
  std::ofstream out(writer.path(), std::ios::binary);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.close();
  if (!out) fail_at_run_time("{}: could not be written; is the disk full?", file.string());
  writer.commit();
}

}  // namespace

void write_vtu(const std::filesystem::path& file, std::span<const Vec3> points, std::span<const int> cells,
               int points_per_cell, const std::vector<VtuArray>& at_points,
               const std::vector<VtuArray>& in_cells) {
  const std::size_t count = cells.size() / static_cast<std::size_t>(points_per_cell);
  std::vector<int> ends(count);
  for (std::size_t i = 0; i < count; ++i) ends[i] = static_cast<int>(i + 1) * points_per_cell;
  const std::vector<std::uint8_t> types(count,
                                        points_per_cell == 4 ? kVtkTetrahedron : kVtkQuadraticTetrahedron);
  Appended appended;
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n";
  text += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", points.size(), count);
  text += "<PointData>\n" + appended.add(at_points) + "</PointData>\n<CellData>\n" + appended.add(in_cells) +
          "</CellData>\n<Points>\n" +
          appended.add("Float64", "Points", 3, std::span(points.front().data(), 3 * points.size())) +
          "</Points>\n<Cells>\n" + appended.add("Int32", "connectivity", 1, cells) +
          appended.add("Int32", "offsets", 1, std::span<const int>(ends)) +
          appended.add("UInt8", "types", 1, std::span<const std::uint8_t>(types)) +
          "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  write_atomically(file, text + appended.bytes() + "\n</AppendedData>\n</VTKFile>\n");
}

namespace {

std::string in_xml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') {
      escaped += "&amp;";
    } else if (c == '<') {
      escaped += "&lt;";
    } else if (c == '"') {
      escaped += "&quot;";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

}  // namespace

void write_pvd(const std::filesystem::path& file,
               const std::vector<std::pair<double, std::filesystem::path>>& at_times) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
  for (const auto& [time, name] : at_times)
    text += fmt::format("<DataSet timestep=\"{:.9g}\" file=\"{}\"/>\n", time, in_xml(name.string()));
  write_atomically(file, text + "</Collection>\n</VTKFile>\n");
}

}  // namespace palpate::sim
