#include "sim_server/sparse/fill_reducing_order.h"

#include <array>
#include <metis.h>
#include <mutex>
#include <new>
#include <numeric>
#include <stdexcept>
#include <suitesparse/amd.h>

namespace palpate::sim {
namespace {

/// Empty where METIS fails, other than for want of memory.
std::vector<int> nested_dissection(const MatrixGraph& graph) {
  idx_t vertices = graph.vertices();
  std::vector<idx_t> begin(graph.begin.begin(), graph.begin.end());
  std::vector<idx_t> neighbours(graph.neighbours.begin(), graph.neighbours.end());
  std::vector<idx_t> order(graph.begin.size() - 1), place(order.size());
  std::array<idx_t, METIS_NOPTIONS> options{};
  METIS_SetDefaultOptions(options.data());
  options[METIS_OPTION_SEED] = 4321;  // METIS' own default, written down
  // METIS draws from one sequence of random numbers, which all threads have in common: two calls at a time
  // would find another order in each run.
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);
  const int status = METIS_NodeND(&vertices, begin.data(), neighbours.data(), nullptr, options.data(),
                                  order.data(), place.data());
  if (status == METIS_ERROR_MEMORY) throw std::bad_alloc();
  if (status != METIS_OK) return {};
  return {order.begin(), order.end()};
}

std::vector<int> minimum_degree(const MatrixGraph& graph) {
  const std::vector<SuiteSparse_long> begin(graph.begin.begin(), graph.begin.end());
  const std::vector<SuiteSparse_long> neighbours(graph.neighbours.begin(), graph.neighbours.end());
  std::vector<SuiteSparse_long> order(graph.begin.size() - 1);
  const auto status =
      amd_l_order(graph.vertices(), begin.data(), neighbours.data(), order.data(), nullptr, nullptr);
  if (status == AMD_OUT_OF_MEMORY) throw std::bad_alloc();
  if (status == AMD_INVALID) throw std::invalid_argument("the graph of a matrix is not sound");
  return {order.begin(), order.end()};
}

}  // namespace

Elimination fill_reducing_order(const MatrixGraph& graph) {
  if (graph.neighbours.empty()) {  // both libraries refuse a graph without edges
    std::vector<int> order(static_cast<std::size_t>(graph.vertices()));
    std::iota(order.begin(), order.end(), 0);
    return Elimination(graph, order);
  }
  Elimination by_degree(graph, minimum_degree(graph));
  const std::vector<int> dissected = nested_dissection(graph);
  if (dissected.empty()) return by_degree;
  Elimination by_dissection(graph, dissected);
  return by_dissection.multiplications() < by_degree.multiplications() ? by_dissection : by_degree;
}

}  // namespace palpate::sim
