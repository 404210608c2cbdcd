#pragma once
/// Meshes from files, in the format every mesher writes or can be converted to.
#include <filesystem>

#include "sim_server/mesh/tet_mesh.h"

namespace palpate::sim {

/// Reads a Gmsh MSH file, version 2.2 or 4.1, text or binary (this machine's byte order), and validates it.
///
/// The 4-node tetrahedra make the solid, in file order; vertices none of them uses are dropped. 3-node
/// triangles in a physical group give `surface_tags`: vertices ascending, under the group's name if the file
/// has one, else its number (4.1 files that Gmsh has partitioned give no tags). Other elements and sections
/// are skipped; tetrahedra of higher order are an error. The file's numbers are taken as metres.
///
/// Throws `Error`, one line: `FILE:LINE: ...` (text) or `FILE: byte N: ...` (binary) for a broken file, the
/// command that converts it for any other format, and what `validate` finds. No count in the file is believed
/// unless the rest of the file is long enough for it. Holds the file in memory; O(size log size).
TetMesh read_mesh(const std::filesystem::path& file);

}  // namespace palpate::sim
