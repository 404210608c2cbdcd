#pragma once
#include "common/triple_buffer.h"

namespace palpate {

/// Wait-free mailbox between one writer and one reader that keeps only the newest value. Neither side ever
/// waits, locks or allocates; a value that was overtaken before it was read is gone. `T` is copied whole, so
/// keep it trivially copyable and small.
template <class T>
class LatestValue {
 public:
  /// Writer thread only: replaces whatever waits.
  void write(const T& value) noexcept {
    slots_.back() = value;
    slots_.publish();
  }

  /// Reader thread only: copies the newest value into `out` and returns true if one came since the last read;
  /// otherwise leaves `out` alone and returns false.
  bool read(T& out) noexcept {
    if (!slots_.take()) return false;
    out = slots_.front();
    return true;
  }

 private:
  TripleBuffer<T> slots_;
};

}  // namespace palpate
