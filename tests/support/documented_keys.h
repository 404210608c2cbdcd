#pragma once
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <functional>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/error.h"
#include "tests/support/paths.h"
#include "tests/support/temporary_folder.h"

namespace palpate::test {

/// "[mesh] file", and "title" at the top of a file.
inline std::string full_key(const std::string& section, const std::string& key) {
  return section.empty() ? key : fmt::format("{} {}", section, key);
}

/// The keys in the table of configs/README.md whose first head is `head`, with their sections.
inline std::set<std::string> documented_keys(const std::string& head) {
  std::ifstream file(source_dir() + "/configs/README.md");
  std::set<std::string> keys;
  std::string line;
  while (std::getline(file, line) && !line.starts_with("| " + head + " |")) {
  }
  static const std::regex quoted("`(\\[+[a-z_.]+\\]+ )?([a-z_]+)`");
  while (std::getline(file, line) && line.starts_with("|")) {
    const std::string cell = line.substr(1, line.find('|', 1) - 1);
    std::string section;  // of the keys after it, too
    for (std::sregex_iterator at(cell.begin(), cell.end(), quoted), end; at != end; ++at) {
      if ((*at)[1].matched) section = (*at)[1].str().substr(0, (*at)[1].length() - 1);
      keys.insert(full_key(section, (*at)[2]));
    }
  }
  return keys;
}

/// Every name that sources of the programs ask a file for, without its section.
inline std::set<std::string> names_in_sources() {
  static const std::regex asked("\\b(number|integer|flag|texts?|vector|box|files?|has|says)\\(\"([a-z_]+)\"");
  static const std::regex listed("kKeys\\{([^}]*)\\}"), name("\"([a-z_]+)\"");
  std::set<std::string> names;
  for (const char* const folder : {"/common", "/haptic_client", "/sim_server"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source_dir() + folder)) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
      std::ifstream file(entry.path());
      const std::string text{std::istreambuf_iterator<char>(file), {}};
      for (std::sregex_iterator at(text.begin(), text.end(), asked), end; at != end; ++at)
        names.insert((*at)[2]);
      for (std::sregex_iterator at(text.begin(), text.end(), listed), end; at != end; ++at) {
        const std::string keys = (*at)[1];
        for (std::sregex_iterator key(keys.begin(), keys.end(), name); key != end; ++key)
          names.insert((*key)[1]);
      }
    }
  }
  return names;
}

/// A file that can be read: heads of sections, "" at the top, and the lines of each.
using Sections = std::vector<std::pair<std::string, std::vector<std::string>>>;

/// The keys of these sections that `read` asks for, of all `names`. Each is tried alone, with a date for its
/// value: no key has one, so a reader that knows the key says what it must be instead.
inline std::set<std::string> known_keys(const Sections& sections, const std::set<std::string>& names,
                                        const std::function<void(const std::filesystem::path&)>& read) {
  const TemporaryFolder folder;
  folder.write("organ.msh", "");
  std::set<std::string> known;
  for (const auto& [section, its_lines] : sections) {
    for (const std::string& name : names) {
      std::string text;
      for (const auto& [head, lines] : sections) {
        text += head + "\n";
        for (const std::string& line : lines) {
          if (head != section || !line.starts_with(name + " =")) text += line + "\n";
        }
        if (head == section) text += name + " = 1979-05-27\n";
      }
      try {
        read(folder.write("file.toml", text));
      } catch (const Error& e) {
        const std::string key = full_key(section, name);
        if (std::string(e.what()).find(fmt::format("`{}` must be ", key)) != std::string::npos)
          known.insert(key);
      }
    }
  }
  return known;
}

/// Names that are in one set alone, each behind the name of that set.
inline std::vector<std::string> differences(const std::set<std::string>& documented,
                                            const std::set<std::string>& known) {
  std::vector<std::string> found;
  for (const std::string& key : documented) {
    if (!known.contains(key)) found.push_back("documented, but not known: " + key);
  }
  for (const std::string& key : known) {
    if (!documented.contains(key)) found.push_back("known, but not documented: " + key);
  }
  return found;
}

}  // namespace palpate::test
