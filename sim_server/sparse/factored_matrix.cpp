#include "sim_server/sparse/factored_matrix.h"

#include <fmt/core.h>
#include <numeric>

#include "common/memory_budget.h"
#include "common/parallel.h"

namespace palpate::sim {

void FactoredMatrix::inverse_rows(std::span<const int> unknowns, std::span<const int> begins,
                                  const TakeRows& take, const std::function<void(double)>& progress) const {
  const auto m = static_cast<Eigen::Index>(unknowns.size());
  require_memory(static_cast<double>(m * m) * sizeof(double), free_memory(), "compliance",
                 fmt::format("a dense block of the inverse, {} of its unknowns,", m),
                 "give [[tool]] a `reach` box around the part it touches");
  Eigen::MatrixXd block(m, m);
  inverse_block(unknowns, block, progress);
  std::vector<int> groups(begins.size() - 1);
  std::iota(groups.begin(), groups.end(), 0);
  parallel_blocks(groups.size(), 1, [&](std::size_t group, std::size_t) {
    const int begin = begins[group], count = begins[group + 1] - begin;
    take(groups[group], std::span(groups).subspan(group), block.middleRows(begin, count));
  });
}

}  // namespace palpate::sim
