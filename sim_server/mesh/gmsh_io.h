#pragma once
/// Meshes from files, in the format every mesher writes or can be converted to.
#include <filesystem>

#include "sim_server/mesh/mesh_faults.h"

namespace palpate::sim {

/// A mesh as `mend` left it, and what it found.
struct CheckedMesh {
  TetMesh mesh;
  MeshFaults faults;
};

/// Reads a Gmsh MSH file, version 2.2 or 4.1, text or binary (this machine's byte order), and mends it.
///
/// The 4-node tetrahedra make the solid, in file order. 3-node triangles in a physical group give
/// `surface_tags`: vertices ascending, under the group's name if the file has one, else its number (4.1 files
/// that Gmsh has partitioned give no tags). Other elements and sections are skipped; tetrahedra of higher
/// order are an error. The file's numbers times `scale` are metres.
///
/// Throws `Error`, one line: `FILE:LINE: ...` (text) or `FILE: byte N: ...` (binary) for a broken file, the
/// command that converts it for any other format. No count in the file is believed unless the rest of the
/// file is long enough for it. Holds the file in memory; O(size log size).
CheckedMesh check_mesh(const std::filesystem::path& file, double scale = 1);

/// Reads a mesh as `check_mesh` does, for use: also throws what `require_usable` does; logs one line where it
/// was mended.
TetMesh read_mesh(const std::filesystem::path& file, double scale = 1);

}  // namespace palpate::sim
