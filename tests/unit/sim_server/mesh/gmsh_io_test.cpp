#include "sim_server/mesh/gmsh_io.h"

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <fstream>
#include <string>
#include <unistd.h>

#include "common/error.h"
#include "tests/support/catch.h"

namespace palpate::sim {
namespace {

/// A directory of this test alone, removed with its contents.
class Scratch {
 public:
  Scratch() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() / fmt::format("palpate_gmsh_io_{}_{}", getpid(), count++);
    std::filesystem::create_directories(path_);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() { std::filesystem::remove_all(path_); }

  std::filesystem::path write(const std::string& bytes, const std::string& name = "mesh.msh") const {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }
  /// What reading says about `bytes`, with FILE for the path; empty when it reads them.
  std::string error_of(const std::string& bytes, const std::string& name = "mesh.msh") const {
    const std::string file = write(bytes, name).string();
    std::string message;
    try {
      require_usable(check_mesh(file).faults, file);  // as `read_mesh`, but for its line in the log
    } catch (const Error& error) {
      message = error.what();
    }
    for (std::size_t at; (at = message.find(file)) != std::string::npos;)
      message.replace(at, file.size(), "FILE");
    return message;
  }

 private:
  std::filesystem::path path_;
};

struct Flavour {
  bool is_41, binary;
};

const Flavour kFlavours[] = {{false, false}, {false, true}, {true, false}, {true, true}};

/// Puts the same numbers down as text or as bytes.
struct Writer {
  Flavour flavour;
  std::string out;

  template <class Number>
  void raw(Number value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  Writer& ints(std::initializer_list<int> values) {
    for (const int value : values) flavour.binary ? raw(value) : text(value);
    return *this;
  }
  Writer& numbers(std::initializer_list<std::int64_t> values) {
    for (const std::int64_t value : values) {
      if (!flavour.binary)
        text(value);
      else if (flavour.is_41)
        raw(value);
      else
        raw(static_cast<std::int32_t>(value));
    }
    return *this;
  }
  Writer& reals(const Vec3& values) {
    for (const double value : values) flavour.binary ? raw(value) : text(value);
    return *this;
  }
  Writer& line(const std::string& words) {
    out += words + "\n";
    return *this;
  }
  Writer& end(const std::string& words) { return line("\n" + words); }
  template <class Number>
  void text(Number value) {
    out += fmt::format("{} ", value);
  }
};

// The unit cube of six tetrahedra: corner 4a + 2b + c is at (a, b, c). Not contiguous, not sorted, one beyond
// 2^30.
const std::int64_t kNumbers[] = {1999999999, 30, 29, 7, 1000, 8, 77, 12};
const std::int64_t kLoose = 500;  // a node in no tetrahedron
const Tetrahedron kCube[] = {{0, 4, 6, 7}, {0, 5, 4, 7}, {0, 6, 2, 7},
                             {0, 2, 3, 7}, {0, 1, 5, 7}, {0, 3, 1, 7}};
const Triangle kBase[] = {{0, 2, 6}, {0, 6, 4}};  // c = 0; physical group 17, "base plate"
const Triangle kSide[] = {{0, 1, 3}, {0, 3, 2}};  // a = 0; physical group 23, without a name

Vec3 corner(int i) {
  const int a = i / 4, b = i / 2 % 2, c = i % 2;
  return Vec3(a, b, c);
}

void start(Writer& w) {
  w.line("$MeshFormat")
      .line(fmt::format("{} {} 8", w.flavour.is_41 ? "4.1" : "2.2", w.flavour.binary ? 1 : 0));
  if (w.flavour.binary) w.ints({1}).line("");
  w.line("$EndMeshFormat");
  w.line("$PhysicalNames")
      .line("2")
      .line("2 17 \"base plate\"")
      .line("3 17 \"organ\"")
      .line("$EndPhysicalNames");
  w.line("$Comments").line("$Nodes is yet to come").line("$EndComments");
}

std::string cube_22(const Flavour& flavour) {
  Writer w{flavour, ""};
  start(w);
  w.line("$Nodes").line("9").numbers({kLoose}).reals({9, 9, 9});
  for (int i = 0; i < 8; ++i) w.numbers({kNumbers[i]}).reals(corner(i));
  w.end("$EndNodes").line("$Elements").line("11");
  int number = 1;
  const auto run = [&](int type, int size) {
    if (flavour.binary) w.ints({type, size, 2});
  };
  const auto element = [&](int type, int physical, std::initializer_list<std::int64_t> nodes) {
    w.numbers({number++});
    if (!flavour.binary) w.ints({type, 2});
    w.ints({physical, 1}).numbers(nodes);
  };
  run(1, 1);
  element(1, 99, {kLoose, kNumbers[0]});
  run(2, 4);
  for (const auto& [a, b, c] : kBase) element(2, 17, {kNumbers[a], kNumbers[b], kNumbers[c]});
  for (const auto& [a, b, c] : kSide) element(2, 23, {kNumbers[a], kNumbers[b], kNumbers[c]});
  run(4, 6);
  for (const auto& [a, b, c, d] : kCube) element(4, 17, {kNumbers[a], kNumbers[b], kNumbers[c], kNumbers[d]});
  return w.end("$EndElements").out;
}

std::string cube_41(const Flavour& flavour) {
  Writer w{flavour, ""};
  start(w);
  w.line("$Entities").numbers({1, 1, 2, 1});
  const auto box = [&](int tag) { w.ints({tag}).reals({0, 0, 0}).reals({1, 1, 1}); };
  w.ints({1}).reals({0, 0, 0}).numbers({0});
  box(1);
  w.numbers({1}).ints({99}).numbers({2}).ints({1, -1});
  box(4);
  w.numbers({1}).ints({17}).numbers({0});
  box(9);
  w.numbers({1}).ints({-23}).numbers({0});
  box(1);
  w.numbers({1}).ints({17}).numbers({2}).ints({4, 9});
  w.end("$EndEntities").line("$Nodes").numbers({2, 9, 7, 1999999999});
  w.ints({2, 4, 1}).numbers({1}).numbers({kLoose}).reals({9, 9, 9});
  w.reals({0.5, 0.25, 0});  // the first two: parameters, as 1 announced
  w.out.erase(w.out.size() - (flavour.binary ? sizeof(double) : 2));
  w.ints({3, 1, 0}).numbers({8});
  for (int i = 0; i < 8; ++i) w.numbers({kNumbers[i]});
  for (int i = 0; i < 8; ++i) w.reals(corner(i));
  w.end("$EndNodes").line("$Elements").numbers({4, 11, 1, 11});
  w.ints({1, 1, 1}).numbers({1, 1, kLoose, kNumbers[0]});
  w.ints({2, 4, 2}).numbers({2});
  for (const auto& [a, b, c] : kBase) w.numbers({2, kNumbers[a], kNumbers[b], kNumbers[c]});
  w.ints({2, 9, 2}).numbers({2});
  for (const auto& [a, b, c] : kSide) w.numbers({2, kNumbers[a], kNumbers[b], kNumbers[c]});
  w.ints({3, 1, 4}).numbers({6});
  for (const auto& [a, b, c, d] : kCube) w.numbers({3, kNumbers[a], kNumbers[b], kNumbers[c], kNumbers[d]});
  return w.end("$EndElements").out;
}

std::string cube(const Flavour& flavour) {
  return flavour.is_41 ? cube_41(flavour) : cube_22(flavour);
}

/// `text` with every `old` replaced; there is one at least.
std::string replaced(std::string text, const std::string& old, const std::string& with) {
  std::size_t at = text.find(old);
  REQUIRE(at != std::string::npos);
  for (; at != std::string::npos; at = text.find(old, at + with.size())) text.replace(at, old.size(), with);
  return text;
}

const std::string kHead22 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string kHead41 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
const std::string kNodes22 = "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";
const std::string kElements22 = "$Elements\n1\n1 4 0 1 2 3 4\n$EndElements\n";

TEST_CASE("a cube comes out of every flavour of the format", "[mesh]") {
  const Scratch scratch;
  for (const Flavour& flavour : kFlavours) {
    CAPTURE(flavour.is_41, flavour.binary);
    const TetMesh mesh = read_mesh(scratch.write(cube(flavour)));
    REQUIRE(mesh.vertices.size() == 8);
    for (int i = 0; i < 8; ++i) CHECK(mesh.vertices[i] == corner(i));
    CHECK(mesh.tetrahedra == std::vector<Tetrahedron>(std::begin(kCube), std::end(kCube)));
    REQUIRE(mesh.surface_tags.size() == 2);
    CHECK(mesh.surface_tags.at("base plate") == std::vector<int>{0, 2, 4, 6});
    CHECK(mesh.surface_tags.at("23") == std::vector<int>{0, 1, 2, 3});
    for (const Triangle& t : mesh.tagged_triangles.at("base plate"))
      CHECK((t[0] < t[1] && t[1] < t[2] && t[0] % 2 + t[1] % 2 + t[2] % 2 == 0));
    CHECK(mesh.tagged_triangles.at("base plate").size() == 2);
  }
}

TEST_CASE("a file cut anywhere is an error", "[mesh]") {
  const Scratch scratch;
  for (const Flavour& flavour : kFlavours) {
    const std::string bytes = cube(flavour);
    for (std::size_t size = 0; size + 1 < bytes.size(); ++size) {  // without the last newline it is whole
      if (scratch.error_of(bytes.substr(0, size)).empty()) FAIL("read a file cut at byte " << size);
    }
  }
}

TEST_CASE("a wrong byte anywhere gives a mesh or an error", "[mesh]") {
  const Scratch scratch;
  for (const Flavour& flavour : kFlavours) {
    const std::string bytes = cube(flavour);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      for (const char wrong : {'\0', '9', '\x7f', '\xff'}) {
        std::string copy = bytes;
        copy[i] = wrong;
        scratch.error_of(copy);
      }
    }
  }
  SUCCEED("no crash, no hang");
}

TEST_CASE("lenient where the format is", "[mesh]") {
  const Scratch scratch;
  const std::string windows = replaced(kHead22 + kNodes22 + kElements22, "\n", "\r\n");
  CHECK(scratch.error_of(windows).empty());
  CHECK(scratch.error_of(kHead22 + kNodes22 + "$NodeData\n1\n\"u\"\n$EndNodeData\n" + kElements22).empty());
  // Gmsh 2.2 repeats an element for each of its physical groups.
  const std::string twice = "$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 2 2 1 1 2 3 4\n$EndElements\n";
  CHECK(read_mesh(scratch.write(kHead22 + kNodes22 + twice)).tetrahedra.size() == 1);
  // Physical group 0: none.
  const std::string untagged = "$Elements\n2\n1 2 2 0 1 1 2 3\n2 4 0 1 2 3 4\n$EndElements\n";
  CHECK(read_mesh(scratch.write(kHead22 + kNodes22 + untagged)).surface_tags.empty());
}

TEST_CASE("node numbers may exceed 32 bits in 4.1", "[mesh]") {
  const Scratch scratch;
  const std::string out = replaced(cube({true, false}), "1999999999", "9000000000000000000");
  CHECK(read_mesh(scratch.write(out)).vertices.size() == 8);
}

TEST_CASE("counts that lie are found before memory is asked for", "[mesh]") {
  const Scratch scratch;
  const std::string huge = "1000000000000000000";
  for (const std::string& count : {huge, std::string("-1"), std::string("400000")}) {
    const auto error = [&](const std::string& bytes) {
      return scratch.error_of(replaced(bytes, "N_", count));
    };
    CHECK(error(kHead22 + "$Nodes\nN_\n1 0 0 0\n$EndNodes\n") ==
          fmt::format("FILE:5: {} nodes announced, but the rest of the file has room for at most 2", count));
    CHECK(error(kHead22 + kNodes22 + "$Elements\nN_\n1 4 0 1 2 3 4\n$EndElements\n") ==
          fmt::format("FILE:12: {} elements announced, but the rest of the file has room for at most 4",
                      count));
    CHECK_FALSE(error(kHead22 + "$PhysicalNames\nN_\n$EndPhysicalNames\n").empty());
    CHECK_FALSE(error(kHead41 + "$Entities\n0 0 0 N_\n$EndEntities\n").empty());
    CHECK_FALSE(error(kHead41 + "$Entities\n1 0 0 0\n1 0 0 0 N_\n$EndEntities\n").empty());
    CHECK_FALSE(error(kHead41 + "$Nodes\nN_ 1 1 1\n$EndNodes\n").empty());
    CHECK_FALSE(error(kHead41 + "$Nodes\n1 1 1 1\n3 1 0 N_\n$EndNodes\n").empty());
  }
  Writer w{{true, true}, ""};
  start(w);
  const std::size_t at = w.out.size() + 7 + 8;  // after $Nodes and the number of blocks
  w.line("$Nodes").numbers({1, 1000000000000000000, 1, 1}).end("$EndNodes");
  CHECK(scratch.error_of(w.out).find(fmt::format("FILE: byte {}: {} nodes announced", at, huge)) == 0);
}

TEST_CASE("triangles that many physical groups would keep are refused before memory is asked for", "[mesh]") {
  const Scratch scratch;
  const auto file = [&](int groups, int triangles) {
    std::string text = kHead41 + fmt::format("$Entities\n0 0 1 0\n1 0 0 0 1 1 1 {}", groups);
    for (int k = 1; k <= groups; ++k) text += fmt::format(" {}", k);
    text += " 0\n$EndEntities\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n";
    text += fmt::format("$Elements\n2 {0} 1 {0}\n3 1 4 1\n1 1 2 3 4\n2 1 2 {1}\n", triangles + 1, triangles);
    for (int k = 0; k < triangles; ++k) text += fmt::format("{} 1 3 2\n", k + 2);
    return text + "$EndElements\n";
  };
  CHECK(scratch.error_of(file(2000, 2000)).find("2000 triangles in 2000 physical groups") !=
        std::string::npos);
  CHECK(scratch.error_of(file(20, 2000)).empty());
}

TEST_CASE("counts that are too small or do not add up", "[mesh]") {
  const Scratch scratch;
  CHECK(scratch.error_of(kHead22 + replaced(kNodes22, "\n4\n", "\n3\n")) ==
        "FILE:9: expected $EndNodes, found \"4\"");
  const std::string text = cube({true, false});
  CHECK(scratch.error_of(replaced(text, "2 9 7 ", "2 8 7 "))
            .find("the blocks hold 9 nodes, but 8 were announced") != std::string::npos);
  CHECK(scratch.error_of(replaced(text, "4 11 1 11", "4 12 1 11"))
            .find("the blocks hold 11 elements, but 12 were announced") != std::string::npos);
}

TEST_CASE("a broken text file is named with its line", "[mesh]") {
  const Scratch scratch;
  const auto error = [&](const std::string& old, const std::string& with) {
    return scratch.error_of(replaced(kHead22 + kNodes22 + kElements22, old, with));
  };
  CHECK(error("2 1 0 0", "2 1 zero 0") == "FILE:7: expected a coordinate of a node, found \"zero\"");
  CHECK(error("2 1 0 0", "2 1 0") == "FILE:10: expected a coordinate of a node, found \"$EndNodes\"");
  CHECK(error("2 1 0 0", "2.5 1 0 0") == "FILE:7: expected the number of a node, found \"2.5\"");
  CHECK(error("2 1 0 0", "3 1 0 0") == "FILE:9: node 3 is given twice");
  CHECK(error("1 2 3 4", "1 2 3 5") == "FILE:13: an element names node 5, which the file does not have");
  CHECK(error("1 4 0", "1 77 0") == "FILE:13: unknown element type 77; save tetrahedra and triangles only");
  CHECK(error("1 4 0", "1 11 0") == "FILE:14: expected a node of an element, found \"$EndElements\"");
  CHECK(error("$EndElements\n", "") == "FILE:14: expected $EndElements, found the end of the file");
  CHECK(error("\n$Elements", "\n# hello\n$Elements") == "FILE:11: expected a section ($Name), found \"#\"");
  CHECK(error("$Nodes", "$ParametricNodes") ==
        "FILE:4: nodes with parameters; save the mesh again without -parametric");
  CHECK(error("$Nodes", "$Periodic\n") ==
        "FILE:4: section $Periodic has no $EndPeriodic: the file is cut short");
  CHECK(error("$Elements\n", kNodes22) == "FILE:11: a second $Nodes");
  CHECK(scratch.error_of(kHead22 + kElements22) == "FILE:4: $Elements before $Nodes");
  CHECK(scratch.error_of(kHead22 + kNodes22) == "FILE:11: the file ends without $Elements");
  CHECK(scratch.error_of(kHead22 + "$PhysicalNames\n1\n2 1 base\n$EndPhysicalNames\n") ==
        "FILE:6: expected the name of physical group 1 in double quotes");
  CHECK(error("2.2 0 8", "2.2 2 8") == "FILE:2: expected 0 (text) or 1 (binary), found 2");
  CHECK(error("2.2 0 8", "2.2 0 8 9") == "FILE:2: expected the end of the line, found \"9\"");
}

TEST_CASE("numbers with a plus, and comments before the format, are read", "[mesh]") {
  const Scratch scratch;
  const std::string plain = kHead22 + kNodes22 + kElements22;
  const TetMesh mesh = read_mesh(scratch.write(plain));
  const TetMesh same = read_mesh(
      scratch.write("$Comments\nmade by X\n$EndComments\n" + replaced(plain, "2 1 0 0", "2 +1.0e+0 +0 -0")));
  CHECK(same.vertices == mesh.vertices);
  CHECK(same.tetrahedra == mesh.tetrahedra);
  CHECK(scratch.error_of(replaced(plain, "2 1 0 0", "2 +-1 0 0")) ==
        "FILE:7: expected a coordinate of a node, found \"+-1\"");
  CHECK(scratch.error_of("$Comments\n$EndComments\n").find("no known format") != std::string::npos);
}

TEST_CASE("tetrahedra and triangles of second order are read by their corners, which is said", "[mesh]") {
  const Scratch scratch;
  std::string nodes = "$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
  for (const char* middle :
       {"5 .5 0 0\n", "6 .5 .5 0\n", "7 0 .5 0\n", "8 0 0 .5\n", "9 0 .5 .5\n", "10 .5 0 .5\n"})
    nodes += middle;
  const CheckedMesh checked = check_mesh(scratch.write(
      kHead22 + nodes +
      "$EndNodes\n$Elements\n2\n1 11 2 1 1 1 2 3 4 5 6 7 8 9 10\n2 9 2 7 1 1 3 2 7 6 5\n$EndElements\n"));
  CHECK_FALSE(checked.faults.refused());
  CHECK(checked.mesh.tetrahedra == std::vector<Tetrahedron>{{0, 1, 2, 3}});
  CHECK(checked.mesh.vertices.size() == 4);
  CHECK(checked.mesh.surface_tags.at("7") == std::vector<int>{0, 1, 2});
  CHECK(mended_in_short(checked.faults).find("tetrahedra of higher order (1) read by their corners") !=
        std::string::npos);
}

TEST_CASE("the parts of a partitioned file are in the groups that it names, volumes too", "[mesh]") {
  const Scratch scratch;
  const std::string file =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
      "$PhysicalNames\n2\n2 5 \"bottom\"\n3 5 \"lesion\"\n$EndPhysicalNames\n"
      "$Entities\n0 0 1 1\n1 0 0 0 1 1 0 1 5 0\n1 0 0 0 1 1 1 1 5 1 1\n$EndEntities\n"
      "$PartitionedEntities\n2\n1\n9 2\n0 0 1 1\n"
      "11 2 1 2 1 2 0 0 0 1 1 0 1 5 0\n12 3 1 1 1 0 0 0 1 1 1 1 5 1 11\n$EndPartitionedEntities\n"
      "$Nodes\n1 4 1 4\n3 12 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
      "$Elements\n2 2 1 2\n2 11 2 1\n1 1 2 3\n3 12 4 1\n2 1 2 3 4\n$EndElements\n";
  const TetMesh mesh = read_mesh(scratch.write(file));
  CHECK(mesh.surface_tags == std::map<std::string, std::vector<int>>{{"bottom", {0, 1, 2}}});
  CHECK(mesh.volume_tags == std::map<std::string, std::size_t>{{"lesion", 1}});
}

TEST_CASE("a solid that cannot be simulated is named with its file", "[mesh]") {
  const Scratch scratch;
  const auto error = [&](const std::string& old, const std::string& with) {
    return scratch.error_of(replaced(kHead22 + kNodes22 + kElements22, old, with));
  };
  CHECK(error("2 1 0 0", "2 nan 0 0").find("FILE: vertex 1 is at (nan, 0, 0)") == 0);
  CHECK(error("1 2 3 4", "1 3 2 4").find("FILE: tetrahedron 0 (vertices 0 2 1 3) is inverted") == 0);
  CHECK(error("4 0 0 1", "4 1 1 0").find("FILE: tetrahedron 0 (vertices 0 1 2 3) is flat") == 0);
  CHECK(error("1 4 0 1 2 3 4", "1 2 0 1 2 3").find("FILE: no tetrahedra") == 0);
}

TEST_CASE("check_mesh reads what read_mesh refuses, and mends as it does", "[mesh]") {
  const Scratch scratch;
  const std::string inverted = replaced(kHead22 + kNodes22 + kElements22, "1 2 3 4", "1 3 2 4");
  const CheckedMesh checked = check_mesh(scratch.write(inverted));
  CHECK(checked.mesh.tetrahedra == std::vector<Tetrahedron>{{0, 2, 1, 3}});
  REQUIRE(checked.faults.found.size() == 1);
  CHECK(checked.faults.found[0].cure == Cure::kRefused);
  // Node 500 of the cube is in no tetrahedron; a triangle of group 17 that names it loses it.
  const std::string tagged = replaced(cube({false, false}), "2 2 2 17 1 1999999999", "2 2 2 17 1 500");
  const CheckedMesh loose = check_mesh(scratch.write(tagged));
  REQUIRE(loose.faults.found.size() == 1);
  CHECK(loose.faults.found[0].kind == "unused vertices");
  CHECK(loose.faults.found[0].count == 1);
  CHECK(loose.mesh.vertices.size() == 8);
}

TEST_CASE("other formats are named with the command that converts them", "[mesh]") {
  const Scratch scratch;
  const std::string gmsh = "2.2 and 4.1 are read; convert it: `gmsh \"FILE\" -save -format msh41 -o OUT.msh`";
  const std::string meshio =
      "not a Gmsh mesh (no $MeshFormat at the start); convert it: `meshio convert \"FILE\" OUT.msh "
      "--output-format "
      "gmsh22`";
  CHECK(scratch.error_of("$NOD\n4\n") == "FILE: a Gmsh MSH 1 file; " + gmsh);
  CHECK(scratch.error_of("$MeshFormat\n4 0 8\n") == "FILE:2: a Gmsh MSH 4.0 file; " + gmsh);
  CHECK(scratch.error_of("# vtk DataFile Version 3.0\n", "a.VTK") == "FILE: .vtk file, " + meshio);
  CHECK(scratch.error_of("MeshVersionFormatted 2\n", "a.mesh") == "FILE: .mesh file, " + meshio);
  CHECK(scratch.error_of("rate_hz = 30\n", "a.toml") ==
        "FILE: a file of settings, not a mesh; a scene names its mesh in [mesh] file");
  CHECK(scratch.error_of("hello\n") == "FILE: no known format, " + meshio);
  CHECK(
      scratch.error_of("v 0 0 0\n", "a.obj").find("FILE: .obj file, a surface without an inside; fill it") ==
      0);
  CHECK(scratch.error_of("") == "FILE: an empty file, not a mesh");
  CHECK_THROWS_AS(read_mesh("/nowhere/liver.msh"), Error);
  CHECK_THROWS_AS(read_mesh(std::filesystem::temp_directory_path()), Error);
}

TEST_CASE("bytes of another machine are refused", "[mesh]") {
  const Scratch scratch;
  const std::string head = "$MeshFormat\n4.1 1 8\n";
  CHECK(scratch.error_of(head + std::string("\0\0\0\1\n", 5))
            .find("FILE: byte 20: bytes in another order; convert") == 0);
  CHECK(scratch.error_of("$MeshFormat\n4.1 1 4\n").find("FILE:2: real numbers of 4 bytes; only 8 are read") ==
        0);
}

}  // namespace
}  // namespace palpate::sim
