#pragma once
/// The scenes that come with Palpate and say what they need.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/programs.h"

namespace palpate::test {

/// A scene file with "# Needs: " in its head.
struct GalleryScene {
  std::string name, file, needs;
  std::vector<std::string> clients;  // those that it names
};

/// What stands in quotes after "clients = [" in a scene file of ours, from its folder.
inline std::vector<std::string> clients_in(const std::string& text, const std::filesystem::path& folder) {
  std::vector<std::string> clients;
  const std::size_t begin = text.find("clients = [");
  if (begin == std::string::npos) return clients;
  const std::size_t end = text.find(']', begin);
  for (std::size_t at = text.find('"', begin); at < end; at = text.find('"', at + 1)) {
    const std::size_t close = text.find('"', at + 1);
    clients.push_back((folder / text.substr(at + 1, close - at - 1)).lexically_normal().string());
    at = close;
  }
  return clients;
}

inline std::vector<GalleryScene> gallery() {
  std::vector<GalleryScene> scenes;
  const std::filesystem::path folder = std::filesystem::path(source_dir()) / "configs" / "scenes";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string text = bytes_of(entry.path());
    const std::size_t needs = text.find("# Needs: ");
    if (needs == std::string::npos) continue;
    scenes.push_back({entry.path().stem().string(), entry.path().string(),
                      text.substr(needs + 2, text.find('\n', needs) - needs - 2), clients_in(text, folder)});
  }
  std::ranges::sort(scenes, {}, &GalleryScene::name);
  return scenes;
}

}  // namespace palpate::test
