#pragma once
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "tests/support/programs.h"

namespace palpate::test {

/// What a .vtu file holds: its counts, and its arrays of 64-bit numbers by name.
struct Vtu {
  struct Array {
    int components = 0;
    std::vector<double> values;
  };
  std::size_t points = 0, cells = 0;
  std::map<std::string, Array> at_points, in_cells, places;

  explicit Vtu(const std::filesystem::path& file) {
    const std::string bytes = bytes_of(file);
    const std::size_t data = bytes.find("<AppendedData encoding=\"raw\">\n_");
    REQUIRE(data != std::string::npos);
    const std::string head = bytes.substr(0, data), raw = bytes.substr(bytes.find('_', data) + 1);
    points = std::stoul(attribute(head, "NumberOfPoints"));
    cells = std::stoul(attribute(head, "NumberOfCells"));
    at_points = arrays(part(head, "PointData"), raw);
    in_cells = arrays(part(head, "CellData"), raw);
    places = arrays(part(head, "Points"), raw);
  }

 private:
  static std::string attribute(const std::string& text, const std::string& name) {
    const std::size_t begin = text.find(name + "=\"");
    REQUIRE(begin != std::string::npos);
    const std::size_t from = begin + name.size() + 2;
    return text.substr(from, text.find('"', from) - from);
  }
  static std::string part(const std::string& head, const std::string& name) {
    const std::size_t begin = head.find("<" + name + ">"), end = head.find("</" + name + ">");
    REQUIRE(begin < end);
    REQUIRE(end != std::string::npos);
    return head.substr(begin, end - begin);
  }
  static std::map<std::string, Array> arrays(const std::string& head, const std::string& raw) {
    std::map<std::string, Array> found;
    for (std::size_t at = head.find("<DataArray"); at != std::string::npos;
         at = head.find("<DataArray", at + 1)) {
      const std::string element = head.substr(at, head.find("/>", at) - at);
      if (attribute(element, "type") != "Float64") continue;
      const std::size_t offset = std::stoul(attribute(element, "offset"));
      std::uint64_t size = 0;
      REQUIRE(offset + sizeof(size) <= raw.size());
      std::memcpy(&size, raw.data() + offset, sizeof(size));
      REQUIRE(offset + sizeof(size) + size <= raw.size());
      Array& array = found[attribute(element, "Name")];
      array.components = std::stoi(attribute(element, "NumberOfComponents"));
      array.values.resize(size / sizeof(double));
      std::memcpy(array.values.data(), raw.data() + offset + sizeof(size), size);
    }
    return found;
  }
};

}  // namespace palpate::test
