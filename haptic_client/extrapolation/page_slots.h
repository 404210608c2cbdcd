#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace palpate::client {

/// Which slot a page is kept in: a hash table with linear probing (Knuth, The Art of Computer Programming 3,
/// 6.4, algorithms L and R), at most half full. Only the constructor allocates: 12 to 24 bytes a slot,
/// however many pages there may be. A look takes a few ns.
class PageSlots {
 public:
  static constexpr std::uint16_t kNone = 0xffff;

  /// Allocates for this number of slots, below 65535.
  explicit PageSlots(std::size_t slots) : rows_(std::bit_ceil(2 * slots)), mask_(rows_.size() - 1) {}

  /// `kNone`: the page is not kept.
  std::uint16_t find(std::uint32_t page) const noexcept { return rows_[place_of(page)].slot; }
  /// A page that is not kept comes into a slot. Pages are above 0.
  void put(std::uint32_t page, std::uint16_t slot) noexcept { rows_[place_of(page)] = {page, slot}; }
  /// A page that is kept goes.
  void erase(std::uint32_t page) noexcept {
    std::size_t gap = place_of(page);
    for (std::size_t i = next(gap); rows_[i].page != 0; i = next(i)) {
      // What would no longer be found behind the gap moves into it.
      if (((i - home_of(rows_[i].page)) & mask_) < ((i - gap) & mask_)) continue;
      rows_[gap] = rows_[i];
      gap = i;
    }
    rows_[gap] = {};
  }
  void clear() noexcept { std::ranges::fill(rows_, Row{}); }

 private:
  struct Row {
    std::uint32_t page = 0;  // 0: empty
    std::uint16_t slot = kNone;
  };
  std::size_t home_of(std::uint32_t page) const noexcept { return (page * 2654435769U >> 8) & mask_; }
  std::size_t next(std::size_t i) const noexcept { return (i + 1) & mask_; }
  /// Returns the row of the page, or the row where it would be inserted.
  std::size_t place_of(std::uint32_t page) const noexcept {
    std::size_t i = home_of(page);
    while (rows_[i].page != 0 && rows_[i].page != page) i = next(i);
    return i;
  }

  std::vector<Row> rows_;
  std::size_t mask_;
};

}  // namespace palpate::client
