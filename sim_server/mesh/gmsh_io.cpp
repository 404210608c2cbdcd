#include "sim_server/mesh/gmsh_io.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/error.h"
#include "common/files.h"
#include "common/log.h"
#include "common/memory_budget.h"
#include "sim_server/mesh/cursor.h"
#include "sim_server/mesh/other_formats.h"

namespace palpate::sim {
namespace {

// Bytes for each of the file, checks of the mesh included; measured: 5 to 7.5.
constexpr double kReadingTakes = 8;
constexpr double kSmallFile = 1e6;  // bytes; to ask for the free memory would take longer than to read it

/// Returns how many nodes an element of Gmsh's `type` has; 0 for a type this reader has never heard of.
int nodes_of_type(std::int64_t type) {
  constexpr std::array<int, 32> kNodes{0, 2,  3,  4,  4, 8,  6,  5,  3,  6,  9, 10, 27, 18, 14, 1,
                                       8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5,  6,  20, 35, 56};
  if (type == 92) return 64;
  if (type == 93) return 125;
  return type > 0 && type < static_cast<int>(kNodes.size()) ? kNodes[static_cast<std::size_t>(type)] : 0;
}

/// A solid element that is no tetrahedron: leaving it out would leave a hole.
bool is_other_solid(std::int64_t type) {
  return (type >= 5 && type <= 7) || (type >= 12 && type <= 14) || (type >= 17 && type <= 19) || type == 92 ||
         type == 93;
}

bool is_curved_tetrahedron(std::int64_t type) {
  return type == 11 || (type >= 29 && type <= 31);
}

/// Corners come first, whatever the order of the element.
bool is_tetrahedron(std::int64_t type) {
  return type == 4 || is_curved_tetrahedron(type);
}

bool is_triangle(std::int64_t type) {
  return type == 2 || type == 9 || (type >= 20 && type <= 25);
}

/// Collects a mesh from the sections of one file.
class MeshReader {
 public:
  MeshReader(const std::string& file, std::string_view bytes) : cursor_(file, bytes) {}

  TetMesh read() {
    format();
    while (!cursor_.at_end()) {
      const std::string name = cursor_.section();
      if (known_section(name)) {
        cursor_.end_section(name);
      } else {
        cursor_.skip_section(name);
      }
    }
    if (!has_nodes_ || !has_elements_) {
      cursor_.wrong("the file ends without ${}", has_nodes_ ? "Elements" : "Nodes");
    }
    tag_surfaces();
    return std::move(all_);
  }
  /// Number of tetrahedra that were read by their corners, as they have more nodes.
  std::size_t curved() const { return curved_; }

 private:
  enum Dimension { kSurface = 2, kVolume = 3 };

  void format() {
    std::string name = cursor_.section();
    for (; name != "MeshFormat"; name = cursor_.section()) cursor_.skip_section(name);
    const auto version = cursor_.text<double>("the version of the format");
    const auto binary = cursor_.text<int>("0 (text) or 1 (binary)");
    const auto real_size = cursor_.text<int>("the size of a real number");
    const std::string again = gmsh_command(cursor_.file());
    is_41_ = version == 4.1;
    if (!is_41_ && version != 2.2)
      cursor_.wrong("a Gmsh MSH {:.1f} file; 2.2 and 4.1 are read; {}", version, again);
    if (binary != 0 && binary != 1) cursor_.wrong("expected 0 (text) or 1 (binary), found {}", binary);
    if (real_size != 8) cursor_.wrong("real numbers of {} bytes; only 8 are read; {}", real_size, again);
    cursor_.end_line();
    if (binary == 1) {
      cursor_.set_binary(is_41_);
      if (cursor_.integer("the byte order mark") != 1) cursor_.wrong("bytes in another order; {}", again);
    }
    cursor_.end_section("MeshFormat");
  }

  /// Reads the body of section `name`, or leaves it alone and says false.
  bool known_section(const std::string& name) {
    if (name == "PhysicalNames") {
      physical_names();
    } else if (name == "Entities" && is_41_) {
      entities(false);
    } else if (name == "PartitionedEntities" && is_41_) {
      cursor_.number("the number of partitions");
      const auto ghosts = cursor_.size(cursor_.number("the number of ghost entities"), 2, "ghost entities");
      for (std::size_t i = 0; i < 2 * ghosts; ++i) cursor_.integer("a ghost entity or its partition");
      entities(true);
    } else if (name == "Nodes") {
      if (has_nodes_) cursor_.wrong("a second $Nodes");
      is_41_ ? nodes_41() : nodes_22();
      number_nodes();
      has_nodes_ = true;
    } else if (name == "Elements") {
      if (!has_nodes_) cursor_.wrong("$Elements before $Nodes");
      is_41_ ? elements_41() : elements_22();
      has_elements_ = true;
    } else if (name == "ParametricNodes") {
      cursor_.wrong("nodes with parameters; save the mesh again without -parametric");
    } else {
      return false;
    }
    return true;
  }

  void physical_names() {
    const auto count = cursor_.size(cursor_.text_count("the number of physical names"), 2, "physical names");
    for (std::size_t i = 0; i < count; ++i) {
      const auto dimension = cursor_.text<int>("the dimension of a physical group");
      const auto tag = cursor_.text<int>("the number of a physical group");
      const std::string_view line = cursor_.line();
      const std::size_t open = line.find('"'), close = line.rfind('"');
      if (open == close) cursor_.wrong("expected the name of physical group {} in double quotes", tag);
      name_of_physical_[{dimension, tag}] = line.substr(open + 1, close - open - 1);
    }
  }

  /// The entities that the elements name: of a partitioned file the parts of those before.
  void entities(bool partitioned) {
    std::array<std::size_t, 4> counts{};  // points, curves, surfaces, volumes
    for (std::size_t& count : counts)
      count = cursor_.size(cursor_.number("a number of entities"), 5, "entities");
    for (int dimension = 0; dimension < 4; ++dimension) {
      for (std::size_t i = 0; i < counts[dimension]; ++i) {
        const std::int64_t tag = cursor_.integer("the number of an entity");
        if (partitioned) partitions_of_entity();
        physicals_of_entity_[{dimension, tag}] = entity_physicals(dimension);
      }
    }
  }

  /// Of which entity a part is, and in which partitions.
  void partitions_of_entity() {
    cursor_.integer("the dimension of a parent entity");
    cursor_.integer("the number of a parent entity");
    const std::int64_t count = cursor_.number("the number of partitions of an entity");
    cursor_.size(count, 1, "partitions");
    for (std::int64_t i = 0; i < count; ++i) cursor_.integer("a partition");
  }

  /// The rest of an entity: where it is (a point, or a box), its physical tags, the entities around it.
  std::vector<std::int64_t> entity_physicals(int dimension) {
    for (int i = 0; i < (dimension == 0 ? 3 : 6); ++i) cursor_.real("a coordinate of an entity");
    const std::int64_t count = cursor_.number("the number of physical tags of an entity");
    std::vector<std::int64_t> tags(cursor_.size(count, 1, "physical tags"));
    for (std::int64_t& tag : tags) tag = cursor_.integer("a physical tag");
    if (dimension == 0) return tags;
    const std::int64_t around = cursor_.number("the number of entities around an entity");
    cursor_.size(around, 1, "entities");
    for (std::int64_t i = 0; i < around; ++i) cursor_.integer("an entity around an entity");
    return tags;
  }

  Vec3 position() {
    Vec3 x;
    for (double& coordinate : x) coordinate = cursor_.real("a coordinate of a node");
    return x;
  }

  void nodes_22() {
    const auto count = cursor_.size(cursor_.text_count("the number of nodes"), 4, "nodes");
    for (std::size_t i = 0; i < count; ++i) {
      node_numbers_.push_back(cursor_.number("the number of a node"));
      all_.vertices.push_back(position());
    }
  }

  void nodes_41() {
    const auto [blocks, total] = header_41("nodes");
    for (std::size_t block = 0; block < blocks; ++block) {
      const std::int64_t dimension = cursor_.integer("the dimension of an entity");
      if (dimension < 0 || dimension > 3) cursor_.wrong("an entity of dimension {}", dimension);
      cursor_.integer("the number of an entity");
      const bool parametric = cursor_.integer("0 or 1 (parametric)") != 0;
      const auto count = cursor_.size(cursor_.number("the number of nodes of a block"), 4, "nodes");
      for (std::size_t i = 0; i < count; ++i) node_numbers_.push_back(cursor_.number("the number of a node"));
      for (std::size_t i = 0; i < count; ++i) {
        all_.vertices.push_back(position());
        for (int k = 0; parametric && k < dimension; ++k) cursor_.real("a parameter of a node");
      }
    }
    check_total(node_numbers_.size(), total, "nodes");
  }

  void number_nodes() {
    for (std::size_t i = 0; i < node_numbers_.size(); ++i) {
      index_of_.emplace_back(node_numbers_[i], static_cast<int>(i));
    }
    std::ranges::sort(index_of_);
    const auto twice = std::ranges::adjacent_find(
        index_of_, [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twice != index_of_.end()) cursor_.wrong("node {} is given twice", twice->first);
  }

  void elements_22() {
    const auto total = cursor_.size(cursor_.text_count("the number of elements"), 3, "elements");
    for (std::size_t done = 0; done < total;) {
      // Binary elements come in runs under one header; as text each has its own, after its number.
      if (!cursor_.binary()) cursor_.number("the number of an element");
      const std::int64_t type = cursor_.integer("the type of an element");
      const std::int64_t run = cursor_.binary() ? cursor_.integer("the number of elements of a run") : 1;
      const std::int64_t tags = cursor_.integer("the number of tags of an element");
      cursor_.size(tags, 1, "tags");
      const auto count = cursor_.size(run, 1 + tags, "elements");
      for (std::size_t i = 0; i < count; ++i) {
        if (cursor_.binary()) cursor_.number("the number of an element");
        const std::int64_t physical = tags > 0 ? cursor_.integer("a tag of an element") : 0;
        for (std::int64_t k = 1; k < tags; ++k) cursor_.integer("a tag of an element");
        element(type, physical);
      }
      done += count;
      if (done > total) cursor_.wrong("more than the {} elements announced", total);
    }
  }

  void elements_41() {
    const auto [blocks, total] = header_41("elements");
    std::size_t done = 0;
    for (std::size_t block = 0; block < blocks; ++block) {
      cursor_.integer("the dimension of an entity");
      const std::int64_t entity = cursor_.integer("the number of an entity");
      const std::int64_t type = cursor_.integer("the type of the elements");
      const auto count = cursor_.size(cursor_.number("the number of elements of a block"), 2, "elements");
      for (std::size_t i = 0; i < count; ++i) {
        cursor_.number("the number of an element");
        element(type, entity);
      }
      done += count;
    }
    check_total(done, total, "elements");
  }

  /// The numbers of blocks and of items that open $Nodes and $Elements in 4.1.
  std::pair<std::size_t, std::size_t> header_41(const char* items) {
    const auto blocks = cursor_.size(cursor_.number("the number of blocks"), 4, "blocks");
    const auto total = cursor_.size(cursor_.number("the number of nodes or elements"), 2, items);
    cursor_.number("the smallest number");
    cursor_.number("the largest number");
    return {blocks, total};
  }

  void check_total(std::size_t done, std::size_t total, const char* items) const {
    if (done != total) cursor_.wrong("the blocks hold {} {}, but {} were announced", done, items, total);
  }

  /// Reads the nodes of an element and keeps what matters.
  void element(std::int64_t type, std::int64_t group) {
    const int count = nodes_of_type(type);
    if (is_other_solid(type)) {
      cursor_.wrong("hexahedra, prisms or pyramids (type {}); mesh the solid with tetrahedra only", type);
    }
    if (count == 0) cursor_.wrong("unknown element type {}; save tetrahedra and triangles only", type);
    int corners = 0;
    if (is_tetrahedron(type)) {
      corners = 4;
      tetrahedron(type, group);
    } else if (is_triangle(type)) {
      corners = 3;
      std::vector<int>& vertices = vertices_of_group_[group];
      for (int i = 0; i < corners; ++i) vertices.push_back(node_index());
    }
    for (int i = corners; i < count; ++i) cursor_.number("a node of an element");
  }

  void tetrahedron(std::int64_t type, std::int64_t group) {
    Tetrahedron t{};
    for (int& vertex : t) vertex = node_index();
    ++tetrahedra_of_group_[group];
    // Format 2.2 repeats an element for each physical group it is in.
    if (!all_.tetrahedra.empty() && all_.tetrahedra.back() == t) return;
    all_.tetrahedra.push_back(t);
    curved_ += is_curved_tetrahedron(type) ? 1 : 0;
  }

  int node_index() {
    const std::int64_t number = cursor_.number("a node of an element");
    const auto at = std::ranges::lower_bound(index_of_, std::pair(number, 0));
    if (at == index_of_.end() || at->first != number) {
      cursor_.wrong("an element names node {}, which the file does not have", number);
    }
    return at->second;
  }

  void tag_surfaces() {
    for (const auto& [group, nodes] : vertices_of_group_) {
      const std::vector<std::int64_t> all_physicals = physicals(kSurface, group);
      require_room_for(all_physicals.size(), nodes.size() / 3);
      for (const std::int64_t physical : all_physicals) {
        if (physical == 0) continue;  // Gmsh's way to say "in no physical group"
        std::vector<int>& vertices = all_.surface_tags[tag_name(kSurface, physical)];
        vertices.insert(vertices.end(), nodes.begin(), nodes.end());
        std::vector<Triangle>& triangles = all_.tagged_triangles[tag_name(kSurface, physical)];
        for (std::size_t k = 0; k + 2 < nodes.size(); k += 3)
          triangles.push_back({nodes[k], nodes[k + 1], nodes[k + 2]});
      }
    }
    sort_tags(all_);
    for (const auto& [group, count] : tetrahedra_of_group_) {
      for (const std::int64_t physical : physicals(kVolume, group)) {
        if (physical != 0) all_.volume_tags[tag_name(kVolume, physical)] += count;
      }
    }
  }

  /// Each physical group of an entity keeps all triangles of that: a short list of both must not ask for more
  /// memory than reading the file does.
  void require_room_for(std::size_t groups, std::size_t triangles) {
    constexpr std::size_t kFewest = 100'000;  // triangles that any file may keep, 1.2 MB
    tagged_ += groups * triangles;
    if (tagged_ > std::max(kFewest, cursor_.bytes_in_all()))
      cursor_.wrong("a surface of {} triangles in {} physical groups, which keep them all; take fewer groups",
                    triangles, groups);
  }

  std::vector<std::int64_t> physicals(Dimension dimension, std::int64_t group) const {
    if (!is_41_) return {group};
    const auto entity = physicals_of_entity_.find({dimension, group});
    return entity == physicals_of_entity_.end() ? std::vector<std::int64_t>{} : entity->second;
  }

  std::string tag_name(Dimension dimension, std::int64_t physical) const {
    const std::int64_t tag = std::abs(physical);  // a minus turns the normals; ours come from the tetrahedra
    const auto name = name_of_physical_.find({dimension, tag});
    return name == name_of_physical_.end() ? fmt::format("{}", tag) : name->second;
  }

  Cursor cursor_;
  std::size_t tagged_ = 0;  // triangles of all physical groups
  bool has_nodes_ = false, has_elements_ = false, is_41_ = false;
  std::vector<std::int64_t> node_numbers_;              // of each vertex, in file order
  std::vector<std::pair<std::int64_t, int>> index_of_;  // node number, vertex; sorted
  TetMesh all_;                                         // every node; no tags yet
  // A group is what elements name: an entity in 4.1, directly a physical tag in 2.2.
  std::map<std::int64_t, std::vector<int>> vertices_of_group_;
  std::map<std::int64_t, std::size_t> tetrahedra_of_group_;
  std::size_t curved_ = 0;
  // By dimension and number.
  std::map<std::pair<int, std::int64_t>, std::vector<std::int64_t>> physicals_of_entity_;
  std::map<std::pair<int, std::int64_t>, std::string> name_of_physical_;
};

std::string read_bytes(const std::filesystem::path& file) {
  require_file(file, "a mesh");
  std::ifstream in(file, std::ios::binary);
  const auto size = std::filesystem::file_size(file);
  if (static_cast<double>(size) > kSmallFile)
    require_memory(kReadingTakes * static_cast<double>(size), free_memory(), file.string(), "reading it",
                   "take a coarser mesh");
  std::string bytes(size, '\0');
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    fail("{}: cannot be read; check its permissions", file.string());
  }
  return bytes;
}

/// True for a file that begins as Gmsh's do, or with a comment before that.
bool is_gmsh(std::string_view bytes) {
  return bytes.starts_with("$MeshFormat") ||
         (bytes.starts_with("$Comments") && bytes.find("\n$MeshFormat") != std::string_view::npos);
}

}  // namespace

CheckedMesh check_mesh(const std::filesystem::path& file, double scale) {
  const std::string bytes = read_bytes(file);
  if (!is_gmsh(bytes)) fail_other_format(file, bytes);
  MeshReader reader(file.string(), bytes);
  CheckedMesh checked{reader.read(), {}};
  for (Vec3& x : checked.mesh.vertices) x *= scale;
  checked.faults = mend(checked.mesh);
  if (reader.curved() > 0)
    checked.faults.found.push_back({Cure::kMended, reader.curved(), "tetrahedra of higher order",
                                    "a tetrahedron has nodes between its corners",
                                    "read by their corners, with straight edges"});
  return checked;
}

TetMesh read_mesh(const std::filesystem::path& file, double scale) {
  CheckedMesh checked = check_mesh(file, scale);
  require_usable(checked.faults, file.string());
  const std::string mended = mended_in_short(checked.faults);
  if (!mended.empty()) log::info("{}: {}", file.string(), mended);
  const std::string slivers = slivers_in_short(checked.faults);
  if (!slivers.empty()) log::warning("{}: {}", file.string(), slivers);
  return std::move(checked.mesh);
}

}  // namespace palpate::sim
