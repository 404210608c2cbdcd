#pragma once
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/types.h"

namespace palpate {

/// Closed range of a number, with its unit for the message.
struct Range {
  double min = -std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::max();
  const char* unit = "";
};

/// Table of a TOML file, read strictly. Every getter checks type and range and marks its key as used.
/// `reject_unknown` then refuses every unused key in the file. All errors are `Error`s that name file, line,
/// key, the expected value and the nearest valid name. Set-up only.
class Config {
 public:
  static Config read(const std::filesystem::path& file);

  /// "FILE:LINE" of this table, or of `key` in it if it is there: where an error about it should point.
  std::string where(const std::string& key = {}) const;

  bool has(const std::string& key) const;
  /// True if the table has this key, which does not belong there; does not mark the key as used.
  bool says(const std::string& key) const;
  double number(const std::string& key, const Range& range, std::optional<double> otherwise = {}) const;
  long integer(const std::string& key, const Range& range, std::optional<long> otherwise = {}) const;
  bool flag(const std::string& key, bool otherwise) const;
  std::string text(const std::string& key, std::optional<std::string> otherwise = {}) const;
  /// Texts in an array: exactly `count` of them, or any number.
  std::vector<std::string> texts(const std::string& key, std::optional<std::size_t> count,
                                 std::vector<std::string> otherwise) const;
  Vec3 vector(const std::string& key, const Range& range, std::optional<Vec3> otherwise = {}) const;
  /// `[[x, y, z], [x, y, z]]`, minimum then maximum, each component in order.
  std::pair<Vec3, Vec3> box(const std::string& key) const;
  /// A path; a relative one starts from the folder of this file.
  std::filesystem::path file(const std::string& key) const;
  /// Any number of them, in an array; none where it is absent.
  std::vector<std::filesystem::path> files(const std::string& key) const;

  /// The sub-table `key`, or nothing where it is absent: then what it describes is not built.
  std::optional<Config> table(const std::string& key) const;
  /// Each `[[key]]` in order; empty where absent.
  std::vector<Config> tables(const std::string& key) const;

  /// Call when all keys of this table were asked for.
  void reject_unknown() const;

 private:
  struct Node;
  explicit Config(std::shared_ptr<Node> node);
  std::shared_ptr<Node> node_;
};

}  // namespace palpate
