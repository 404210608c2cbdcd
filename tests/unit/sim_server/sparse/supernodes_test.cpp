#include "sim_server/sparse/supernodes.h"

#include <algorithm>
#include <numeric>
#include <thread>

#include "sim_server/sparse/fill_reducing_order.h"
#include "tests/support/catch.h"
#include "tests/support/eliminated.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

/// Nodes of a box, joined as in the tetrahedra of its cells along the main diagonal.
MatrixGraph box(int x, int y, int z) {
  const auto number = [&](int i, int j, int k) { return (i * y + j) * z + k; };
  MatrixGraph graph;
  for (int i = 0; i < x; ++i) {
    for (int j = 0; j < y; ++j) {
      for (int k = 0; k < z; ++k) {
        for (int step = 1; step < 8; ++step) {  // back, in ascending numbers
          const int a = i - ((8 - step) >> 2 & 1), b = j - ((8 - step) >> 1 & 1), c = k - ((8 - step) & 1);
          if (a >= 0 && b >= 0 && c >= 0) graph.neighbours.push_back(number(a, b, c));
        }
        for (int step = 1; step < 8; ++step) {
          const int a = i + (step >> 2 & 1), b = j + (step >> 1 & 1), c = k + (step & 1);
          if (a < x && b < y && c < z) graph.neighbours.push_back(number(a, b, c));
        }
        graph.begin.push_back(graph.neighbours.size());
      }
    }
  }
  return graph;
}

/// Of dense blocks, without what is above the diagonal.
double stored(const Supernodes& nodes) {
  double sum = 0;
  for (int s = 0; s < nodes.count(); ++s) {
    const double columns = nodes.first[s + 1] - nodes.first[s];
    sum += columns * static_cast<double>(nodes.rows_of(s).size()) - columns * (columns - 1) / 2;
  }
  return sum;
}

void check_against_elimination(const MatrixGraph& graph, const Elimination& elimination, int width) {
  const Supernodes nodes = find_supernodes(graph, elimination, width);
  const test::Pattern factor = test::eliminated(graph.renumbered(nodes.order));
  CHECK(factor.count() == test::eliminated(graph.renumbered(elimination.order)).count());
  test::Pattern held = test::Pattern::Constant(factor.rows(), factor.cols(), false);
  for (int s = 0; s < nodes.count(); ++s) {
    const std::span<const int> rows = nodes.rows_of(s);
    const int first = nodes.first[s], columns = nodes.first[s + 1] - first;
    REQUIRE(columns > 0);
    CHECK(std::ranges::is_sorted(rows));
    CHECK(std::ranges::adjacent_find(rows) == rows.end());
    for (int c = 0; c < columns; ++c) {
      CHECK(rows[c] == first + c);
      for (const int row : rows.subspan(c)) held(row, first + c) = true;
    }
    // Rows below are of some column of the supernode: none is stored in vain.
    for (const int row : rows.subspan(columns)) CHECK(factor.row(row).segment(first, columns).any());
  }
  CHECK((held.array() || !factor.array()).all());
  CHECK(nodes.first.back() == graph.vertices());
}

}  // namespace

TEST_CASE("supernodes hold all of the factor that a dense elimination finds, and no row in vain") {
  test::Random random(11);
  for (const int vertices : {1, 2, 7, 30, 60}) {
    for (const double probability : {0.0, 0.02, 0.05, 0.2, 0.8}) {
      CAPTURE(vertices, probability);
      const MatrixGraph graph = test::random_graph(vertices, probability, random);
      check_against_elimination(graph, fill_reducing_order(graph), 3);
    }
  }
  const MatrixGraph graph = box(6, 5, 4);
  for (const int width : {1, 3, 40}) check_against_elimination(graph, fill_reducing_order(graph), width);
}

TEST_CASE("merged supernodes have few zeros on a large mesh") {
  const MatrixGraph graph = box(20, 20, 20);
  const Elimination elimination = fill_reducing_order(graph);
  const double entries = std::accumulate(elimination.counts.begin(), elimination.counts.end(), 0.0);
  const double with_zeros = stored(find_supernodes(graph, elimination, 3));
  CHECK(with_zeros >= entries);
  CHECK(with_zeros < 1.15 * entries);
}

TEST_CASE("orders take fewer multiplications than the order of numbers, on cubes and on slender bodies") {
  for (const MatrixGraph& graph : {box(12, 12, 12), box(2, 2, 300), box(3, 3, 3)}) {
    std::vector<int> natural(static_cast<std::size_t>(graph.vertices()));
    std::iota(natural.begin(), natural.end(), 0);
    CHECK(fill_reducing_order(graph).multiplications() < Elimination(graph, natural).multiplications());
  }
  // Nested dissection of a cube takes a power of 6 of its edge, minimum degree alone more.
  CHECK(fill_reducing_order(box(16, 16, 16)).multiplications() <
        90 * fill_reducing_order(box(8, 8, 8)).multiplications());
}

TEST_CASE("an order is the same on each thread and each time", "[threads]") {
  const MatrixGraph graph = box(14, 13, 12);
  const std::vector<int> alone = fill_reducing_order(graph).order;
  std::array<std::vector<int>, 4> orders;
  {
    std::vector<std::jthread> threads;
    for (std::vector<int>& order : orders)
      threads.emplace_back([&] { order = fill_reducing_order(graph).order; });
  }
  for (const std::vector<int>& order : orders) CHECK(order == alone);
}

TEST_CASE("supernodes: a graph without edges is ordered, each vertex once") {
  MatrixGraph graph;
  graph.begin = {0, 0, 0};  // two nodes, as of two tetrahedra on one held face
  const Elimination elimination = fill_reducing_order(graph);
  std::vector<int> order = elimination.order;
  std::ranges::sort(order);
  CHECK(order == std::vector{0, 1});
  CHECK(elimination.counts == std::vector{1, 1});
}
