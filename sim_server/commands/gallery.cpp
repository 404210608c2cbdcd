#include "sim_server/commands/gallery.h"

#include <algorithm>
#include <fmt/core.h>
#include <fstream>
#include <system_error>

#include "common/error.h"

namespace palpate::sim {
namespace {

namespace fs = std::filesystem;

const std::string kNeeds = "Needs: ";  // begins the line of the head that makes a scene one of the gallery

/// Above where this program lies: build/release/bin of the source, or bin of what is installed.
fs::path gallery_folder() {
  std::error_code none;
  const fs::path program = fs::read_symlink("/proc/self/exe", none);
  for (fs::path above = program.parent_path(); above.has_relative_path(); above = above.parent_path()) {
    for (const char* folder : {"share/palpate/scenes", "configs/scenes"}) {
      if (fs::is_directory(above / folder, none)) return above / folder;
    }
  }
  return {};
}

/// Returns what stands between the quotes of `title = "..."`; these files are ours, and read as they are
/// meant.
std::string title_in(const std::string& line) {
  const std::size_t begin = line.find('"'), end = line.rfind('"');
  return line.starts_with("title") && begin < end ? line.substr(begin + 1, end - begin - 1) : "";
}

GalleryScene read_head(const fs::path& file) {
  GalleryScene scene{file.stem().string(), {}, {}, file};
  std::ifstream in(file);
  bool head = true;
  for (std::string line; std::getline(in, line) && scene.title.empty();) {
    head = head && line.starts_with("#");
    if (head) scene.about += line.substr(line.starts_with("# ") ? 2 : 1) + "\n";
    scene.title = title_in(line);
  }
  return scene;
}

}  // namespace

std::vector<GalleryScene> find_gallery() {
  std::vector<GalleryScene> scenes;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(gallery_folder(), none)) {
    if (entry.path().extension() != ".toml") continue;
    GalleryScene scene = read_head(entry.path());
    if (scene.about.starts_with(kNeeds) || scene.about.find("\n" + kNeeds) != std::string::npos)
      scenes.push_back(std::move(scene));
  }
  std::ranges::sort(scenes, {}, &GalleryScene::name);
  return scenes;
}

int list_scenes() {
  const std::vector<GalleryScene> scenes = find_gallery();
  if (scenes.empty())
    fail(
        "found no scenes: share/palpate/scenes belongs beside the folder of this program, or configs/scenes "
        "above it");
  fmt::print("In {}:\n", scenes.front().file.parent_path().string());
  for (const GalleryScene& scene : scenes) {
    fmt::print("\n{}: {}\n", scene.name, scene.title);
    for (std::size_t at = 0; at < scene.about.size();) {
      const std::size_t end = scene.about.find('\n', at);
      fmt::print("  {}\n", scene.about.substr(at, end - at));
      at = end + 1;
    }
  }
  return 0;
}

Command scenes_command() {
  return {.name = "scenes",
          .summary = "The scenes that come with Palpate, and what each shows",
          .footer = "Example: sim_server scenes",
          .run = list_scenes};
}

}  // namespace palpate::sim
