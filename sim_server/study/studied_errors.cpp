#include "sim_server/study/studied_errors.h"

#include <algorithm>
#include <fstream>
#include <iterator>

namespace palpate::sim {
namespace {

void add_file(Fingerprint& print, const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  print.add(std::span(bytes));
}

/// Apart from those of matrices by its first word.
Digest key_of_study(const Scene& scene) {
  constexpr std::string_view kWhat = "study";
  Fingerprint print;
  print.add(std::span(kWhat));
  add_file(print, scene.source);
  add_file(print, scene.mesh_file);
  return print.digest();
}

constexpr double kLeastPress = 1e-6;  // N
constexpr int kNumbers = 9;           // two errors, two corners, a force

}  // namespace

std::optional<StudiedErrors> pressed_in(const Trace& trace) {
  std::optional<StudiedErrors> found;
  for (std::size_t k = 0; k < trace.forces.size(); ++k) {
    if (trace.forces[k].norm() < kLeastPress) continue;
    if (!found) found = {.errors = {}, .pressed = {trace.places[k], trace.places[k]}};
    found->pressed.min = found->pressed.min.cwiseMin(trace.places[k]);
    found->pressed.max = found->pressed.max.cwiseMax(trace.places[k]);
    found->most_newton = std::max(found->most_newton, trace.forces[k].norm());
  }
  return found;
}

void keep_studied(const SetupCache& cache, const Scene& scene, const StudiedErrors& studied, double seconds) {
  Eigen::RowVectorXd row(kNumbers);
  row << static_cast<double>(studied.errors.mesh.percent),
      static_cast<double>(studied.errors.time_step.percent), studied.pressed.min.transpose(),
      studied.pressed.max.transpose(), studied.most_newton;
  cache.keep(key_of_study(scene), seconds, row);
}

std::optional<StudiedErrors> find_studied(const SetupCache& cache, const Scene& scene) {
  const auto stored = cache.find(key_of_study(scene));
  if (!stored || stored->matrix().rows() != 1 || stored->matrix().cols() != kNumbers) return {};
  const Eigen::RowVectorXd row = stored->matrix().row(0);
  const auto measured = [&](int column) {
    return DiscretisationError{ErrorSource::kMeasured, static_cast<float>(row[column])};
  };
  return StudiedErrors{.errors = {measured(0), measured(1)},
                       .pressed = {row.segment<3>(2), row.segment<3>(5)},
                       .most_newton = row[8]};
}

}  // namespace palpate::sim
