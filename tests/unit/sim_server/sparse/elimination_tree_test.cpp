#include "sim_server/sparse/elimination_tree.h"

#include <algorithm>
#include <numeric>

#include "tests/support/catch.h"
#include "tests/support/eliminated.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

std::vector<int> shuffled(int n, test::Random& random) {
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random.bits() % k]);
  return order;
}

/// Works on graphs of 1 to 40 vertices, with no edge up to almost all.
template <class Work>
void for_each_graph(Work work) {
  test::Random random(7);
  for (const int vertices : {1, 2, 5, 13, 40}) {
    for (const double probability : {0.0, 0.03, 0.1, 0.3, 0.9}) {
      CAPTURE(vertices, probability);
      for (int draw = 0; draw < 5; ++draw)
        work(test::random_graph(vertices, probability, random), shuffled(vertices, random));
    }
  }
}

}  // namespace

TEST_CASE("a column's parent is the first row below its diagonal in the factor") {
  for_each_graph([](const MatrixGraph& graph, const std::vector<int>&) {
    const test::Pattern factor = test::eliminated(graph);
    const std::vector<int> parent = parents_of_columns(graph);
    for (int column = 0; column < graph.vertices(); ++column) {
      int first = -1;
      for (int row = graph.vertices() - 1; row > column; --row) {
        if (factor(row, column)) first = row;
      }
      CHECK(parent[column] == first);
    }
  });
}

TEST_CASE("a postorder has each vertex directly after all of its descendants") {
  for_each_graph([](const MatrixGraph& graph, const std::vector<int>&) {
    const std::vector<int> parent = parents_of_columns(graph);
    const std::vector<int> order = postorder(parent);
    std::vector<int> sorted = order;
    std::ranges::sort(sorted);
    for (int v = 0; v < graph.vertices(); ++v) REQUIRE(sorted[v] == v);
    const std::vector<int> above = renumbered_parents(parent, order);
    for (int place = 0; place < graph.vertices(); ++place) {
      const auto is_below = [&](int other) {
        while (other >= 0 && other < place) other = above[other];
        return other == place;
      };
      int descendants = 0;
      for (int other = 0; other < place; ++other) descendants += is_below(other) ? 1 : 0;
      for (int other = place - descendants; other < place; ++other) CHECK(is_below(other));
    }
  });
}

TEST_CASE("an elimination in postorder has the fill of the order given, and counts it column by column") {
  for_each_graph([](const MatrixGraph& graph, const std::vector<int>& given) {
    const Elimination elimination(graph, given);
    const test::Pattern factor = test::eliminated(graph.renumbered(elimination.order));
    double squares = 0;
    for (int column = 0; column < graph.vertices(); ++column) {
      const auto entries = static_cast<int>(factor.col(column).count());
      CHECK(elimination.counts[column] == entries);
      squares += entries * entries;
    }
    CHECK(elimination.multiplications() == squares);
    CHECK(factor.count() == test::eliminated(graph.renumbered(given)).count());
  });
}
