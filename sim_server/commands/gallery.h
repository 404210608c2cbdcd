#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "common/program.h"

namespace palpate::sim {

/// A scene that comes with Palpate, and says in its head what it needs ("# Needs: ...").
struct GalleryScene {
  std::string name;  ///< of its file, without ".toml"
  std::string title;
  std::string about;  ///< the comment at the head of the file, in lines
  std::filesystem::path file;
};

/// Finds the gallery scenes, by name. They are in share/palpate/scenes beside the folder of this program,
/// where it is installed, else in configs/scenes above it; none where neither is there.
std::vector<GalleryScene> find_gallery();

/// `sim_server scenes`: prints them. Throws `Error` where there are none. Returns the exit code.
int list_scenes();

/// `sim_server scenes`.
Command scenes_command();

}  // namespace palpate::sim
