#include "common/timeline.h"

#include "tests/support/catch.h"

using palpate::Time;
using palpate::Timeline;
using namespace std::chrono_literals;

namespace {
struct Count {
  int n = 0;
  Count& operator+=(const Count& other) {
    n += other.n;
    return *this;
  }
};
}  // namespace

TEST_CASE("a time line begins with one-second cells and coarsens without losing anything") {
  Timeline<Count, 8> line;
  const Time begin = 1000s;
  for (int s = 0; s < 8; ++s) line.at(begin + s * 1s).n += s;
  CHECK(line.size() == 8);
  CHECK(line.width() == 1s);
  CHECK(line[7].n == 7);
  line.at(begin + 8s).n += 100;  // one too many: pairs merge
  CHECK(line.width() == 2s);
  CHECK(line.size() == 5);
  CHECK(line[0].n == 0 + 1);
  CHECK(line[3].n == 6 + 7);
  CHECK(line[4].n == 100);
  line.at(begin + 1h).n += 1000;
  CHECK(line.width() == 512s);  // the first power of two with 8 cells beyond an hour
  int sum = 0;
  for (std::size_t i = 0; i < line.size(); ++i) sum += line[i].n;
  CHECK(sum == 28 + 100 + 1000);
}

TEST_CASE("what lies before the beginning of a time line goes to its first cell") {
  Timeline<Count, 8> line;
  line.at(10s).n += 1;
  line.at(3s).n += 2;
  CHECK(line.size() == 1);
  CHECK(line[0].n == 3);
}
