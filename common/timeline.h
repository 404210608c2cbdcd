#pragma once
#include <array>
#include <cstddef>

#include "common/time.h"

namespace palpate {

/// Coarse time line in fixed memory: up to `kCells` cells of equal width side by side. When a session
/// outgrows them, neighbours merge and the width doubles. `Cell` adds up by `operator+=`. No allocation; one
/// thread.
template <class Cell, std::size_t kCells = 64>
class Timeline {
 public:
  /// The cell for time `t`. The first call sets the beginning; what lies before it goes to the first cell.
  Cell& at(Time t) noexcept {
    if (size_ == 0) start_ = t;
    while (t - start_ >= static_cast<Time::rep>(kCells) * width_) merge();
    const std::size_t i = t <= start_ ? 0 : static_cast<std::size_t>((t - start_) / width_);
    if (i >= size_) size_ = i + 1;
    return cells_[i];
  }

  std::size_t size() const noexcept { return size_; }
  const Cell& operator[](std::size_t i) const noexcept { return cells_[i]; }
  /// Returns the width of one cell, at least one second.
  Time width() const noexcept { return width_; }

 private:
  void merge() noexcept {
    for (std::size_t i = 0; i < kCells; ++i) {
      const Cell cell = cells_[i];
      cells_[i] = {};
      cells_[i / 2] += cell;
    }
    size_ = (size_ + 1) / 2;
    width_ *= 2;
  }

  std::array<Cell, kCells> cells_{};
  std::size_t size_ = 0;
  Time start_{}, width_ = std::chrono::seconds(1);
};

}  // namespace palpate
