#include "sim_server/study/studied_errors.h"

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

}  // namespace

void keep_studied(const SetupCache& cache, const Scene& scene, const DiscretisationErrors& errors,
                  double seconds) {
  const Eigen::RowVector2d percent(errors.mesh.percent, errors.time_step.percent);
  cache.keep(key_of_study(scene), seconds, percent);
}

std::optional<DiscretisationErrors> find_studied(const SetupCache& cache, const Scene& scene) {
  const auto stored = cache.find(key_of_study(scene));
  if (!stored || stored->matrix().rows() != 1 || stored->matrix().cols() != 2) return {};
  const auto measured = [&](int column) {
    return DiscretisationError{ErrorSource::kMeasured, static_cast<float>(stored->matrix()(0, column))};
  };
  return DiscretisationErrors{measured(0), measured(1)};
}

}  // namespace palpate::sim
