#include "common/config.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <toml++/toml.h>

#include "common/error.h"
#include "common/files.h"
#include "common/log.h"
#include "common/renamed_keys.h"
#include "common/text.h"

namespace palpate {

struct Config::Node {
  std::shared_ptr<const toml::table> root;
  const toml::table* table;
  std::string file, name;  // name: "[material]" or "" at the top
  std::set<std::string> requested;

  const toml::node* find(const std::string& key) {
    const bool first_time = requested.insert(key).second;
    const toml::node* node = table->get(key);
    const std::string former(former_name(key));
    if (node != nullptr || former.empty() || !table->contains(former)) return node;
    node = table->get(former);
    requested.insert(former);
    if (first_time)
      log::warning("{}: `{}` is named `{}` now; the former name works for one release more", at(*node),
                   full(former), key);
    return node;
  }
  /// The node of `key`, or of its former name, without a request for it.
  const toml::node* peek(const std::string& key) const {
    const toml::node* node = table->get(key);
    return node != nullptr ? node : table->get(former_name(key));
  }
  std::string at(const toml::node& node) const {
    return fmt::format("{}:{}", file, node.source().begin.line);
  }
  std::string full(const std::string& key) const {
    return name.empty() ? key : fmt::format("{} {}", name, key);
  }
  /// "tool.cone" for a section `cone` of a [[tool]].
  std::string name_of(const std::string& section) const {
    const std::size_t first = name.find_first_not_of('['), last = name.find(']');
    return name.empty() ? section : fmt::format("{}.{}", name.substr(first, last - first), section);
  }
  /// The node of `key`; null when absent and `required` is false.
  const toml::node* get(const std::string& key, bool required) {
    const toml::node* node = find(key);
    if (node == nullptr && required) missing(key);
    return node;
  }
  /// Names the key that may be a slip of the pen for it.
  [[noreturn]] void missing(const std::string& key) const {
    const int slip = std::min(3, static_cast<int>(key.size()) / 3);  // letters
    for (const auto& [other, node] : *table) {
      if (!requested.contains(std::string(other.str())) && edit_distance(key, other.str()) <= slip)
        fail("{}: unknown key `{}`; did you mean \"{}\"?", at(node), full(std::string(other.str())), key);
    }
    fail("{}: missing key `{}`", at(*table), full(key));
  }
  [[noreturn]] void wrong(const toml::node& node, const std::string& key, const std::string& expected) const {
    fail("{}: `{}` must be {}", at(node), full(key), expected);
  }
  double number(const toml::node& node, const std::string& key, const Range& range) const {
    const auto value = node.value<double>();
    const std::string unit = *range.unit == 0 ? "" : fmt::format(" ({})", range.unit);
    if (!node.is_number() || !value) wrong(node, key, "a number" + unit);
    if (!std::isfinite(*value) || *value < range.min || *value > range.max) {
      wrong(node, key, fmt::format("between {} and {}{}, not {}", range.min, range.max, unit, *value));
    }
    return *value;
  }
  Vec3 vector(const toml::node& node, const std::string& key, const Range& range) const {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != 3) {
      wrong(node, key,
            fmt::format("three numbers [x, y, z]{}{}", *range.unit == 0 ? "" : " in ", range.unit));
    }
    Vec3 v;
    for (std::size_t i = 0; i < 3; ++i) v[static_cast<int>(i)] = number(*array->get(i), key, range);
    return v;
  }
};

Config::Config(std::shared_ptr<Node> node) : node_(std::move(node)) {}

Config Config::read(const std::filesystem::path& file) {
  require_file(file, "a file");
  if (!std::ifstream(file)) fail("{}: cannot be read; check its permissions", file.string());
  try {
    auto root = std::make_shared<toml::table>(toml::parse_file(file.string()));
    const toml::table* table = root.get();
    return Config(std::make_shared<Node>(Node{std::move(root), table, file.string(), "", {}}));
  } catch (const toml::parse_error& e) {
    fail("{}:{}: not TOML: {}", file.string(), e.source().begin.line, e.description());
  }
}

std::string Config::where(const std::string& key) const {
  const toml::node* node = key.empty() ? nullptr : node_->peek(key);
  return node_->at(node == nullptr ? *node_->table : *node);
}

bool Config::has(const std::string& key) const {
  return node_->find(key) != nullptr;
}

bool Config::says(const std::string& key) const {
  return node_->peek(key) != nullptr;
}

double Config::number(const std::string& key, const Range& range, std::optional<double> otherwise) const {
  const toml::node* node = node_->get(key, !otherwise);
  return node == nullptr ? *otherwise : node_->number(*node, key, range);
}

long Config::integer(const std::string& key, const Range& range, std::optional<long> otherwise) const {
  const toml::node* node = node_->get(key, !otherwise);
  if (node == nullptr) return *otherwise;
  if (!node->is_integer()) node_->wrong(*node, key, "a whole number");
  node_->number(*node, key, range);
  return *node->value<long>();
}

bool Config::flag(const std::string& key, bool otherwise) const {
  const toml::node* node = node_->get(key, false);
  if (node == nullptr) return otherwise;
  if (!node->is_boolean()) node_->wrong(*node, key, "true or false");
  return *node->value<bool>();
}

std::string Config::text(const std::string& key, std::optional<std::string> otherwise) const {
  const toml::node* node = node_->get(key, !otherwise);
  if (node == nullptr) return *otherwise;
  if (!node->is_string()) node_->wrong(*node, key, "text in quotes");
  return *node->value<std::string>();
}

std::vector<std::string> Config::texts(const std::string& key, std::optional<std::size_t> count,
                                       std::vector<std::string> otherwise) const {
  const toml::node* node = node_->get(key, false);
  if (node == nullptr) return otherwise;
  const toml::array* array = node->as_array();
  std::vector<std::string> values;
  if (array != nullptr) {
    for (const toml::node& entry : *array) {
      if (const auto text = entry.value<std::string>(); entry.is_string()) values.push_back(*text);
    }
  }
  if (array == nullptr || values.size() != count.value_or(array->size())) {
    node_->wrong(*node, key,
                 fmt::format("{}texts in quotes, [\"...\", ...]", count ? fmt::format("{} ", *count) : ""));
  }
  return values;
}

Vec3 Config::vector(const std::string& key, const Range& range, std::optional<Vec3> otherwise) const {
  const toml::node* node = node_->get(key, !otherwise);
  return node == nullptr ? *otherwise : node_->vector(*node, key, range);
}

std::pair<Vec3, Vec3> Config::box(const std::string& key) const {
  const toml::node* node = node_->get(key, true);
  const toml::array* corners = node->as_array();
  if (corners == nullptr || corners->size() != 2)
    node_->wrong(*node, key, "two corners [[x, y, z], [x, y, z]] in m");
  const Range metres{.unit = "m"};
  std::pair<Vec3, Vec3> box{node_->vector(*corners->get(0), key, metres),
                            node_->vector(*corners->get(1), key, metres)};
  if ((box.first.array() > box.second.array()).any()) {
    node_->wrong(*node, key, "[minimum corner, maximum corner]; a minimum is larger than its maximum");
  }
  return box;
}

std::filesystem::path Config::file(const std::string& key) const {
  return std::filesystem::path(node_->file).parent_path() / text(key);
}

std::vector<std::filesystem::path> Config::files(const std::string& key) const {
  std::vector<std::filesystem::path> files;
  for (const std::string& text : texts(key, {}, {}))
    files.push_back(std::filesystem::path(node_->file).parent_path() / text);
  return files;
}

std::optional<Config> Config::table(const std::string& key) const {
  const toml::node* node = node_->find(key);
  if (node == nullptr) return {};
  if (!node->is_table()) node_->wrong(*node, key, fmt::format("a table `[{}]`", key));
  return Config(std::make_shared<Node>(
      Node{node_->root, node->as_table(), node_->file, fmt::format("[{}]", node_->name_of(key)), {}}));
}

std::vector<Config> Config::tables(const std::string& key) const {
  const toml::node* node = node_->find(key);
  std::vector<Config> all;
  if (node == nullptr) return all;
  const toml::array* array = node->as_array();
  if (array == nullptr || !array->is_array_of_tables()) {
    node_->wrong(*node, key, fmt::format("one or more tables `[[{}]]` (two brackets)", key));
  }
  for (const toml::node& entry : *array) {
    all.push_back(Config(std::make_shared<Node>(
        Node{node_->root, entry.as_table(), node_->file, fmt::format("[[{}]]", node_->name_of(key)), {}})));
  }
  return all;
}

void Config::reject_unknown() const {
  const std::vector<std::string> known(node_->requested.begin(), node_->requested.end());
  for (const auto& [key, value] : *node_->table) {
    const std::string name(key.str());
    if (node_->requested.contains(name)) continue;
    fail("{}: unknown key `{}`{}", node_->at(value), node_->full(name), suggestion(name, known));
  }
}

}  // namespace palpate
