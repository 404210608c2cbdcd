#pragma once
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "common/report.h"
#include "haptic_client/evaluation/observation.h"

namespace palpate::client {

/// A CSV with a row a tick, live or replayed: the columns are in session/REPORT.md. Numbers are written
/// so that reading them gives the same bits back: equal files mean equal forces. Not for a running loop.
class TraceWriter {
 public:
  /// `laws`: names of the scored laws, a column each. Throws `Error`.
  TraceWriter(const std::filesystem::path& file, const std::vector<std::string>& laws);
  void add(const TickRecord& tick);
  /// The file appears. Throws `Error` when it could not be written.
  void finish();

 private:
  void add_error(const DiscretisationError& error);
  void add_errors(const TickRecord& tick);
  void flush();

  std::filesystem::path name_;
  AtomicFile file_;
  std::ofstream out_;
  std::string text_;
  std::size_t laws_;
  std::optional<Time> start_;
};

}  // namespace palpate::client
