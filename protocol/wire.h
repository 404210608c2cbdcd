#pragma once
/// Little-endian bytes on any machine.
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "common/types.h"

namespace palpate::protocol {

/// Appends fields to a buffer the caller made large enough (asserted by the codec, which knows the sizes).
class Writer {
 public:
  explicit Writer(std::span<std::byte> out) : out_(out) {}

  template <class T>
  requires std::is_integral_v<T>
  void operator()(T value) noexcept {
    auto bits = static_cast<std::make_unsigned_t<T>>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      out_[at_++] = static_cast<std::byte>(bits & 0xff);
      if constexpr (sizeof(T) > 1) bits = static_cast<std::make_unsigned_t<T>>(bits >> 8);
    }
  }
  template <class T>
  requires std::is_enum_v<T>
  void operator()(T value) noexcept { (*this)(static_cast<std::underlying_type_t<T>>(value)); }
  void operator()(double value) noexcept { (*this)(std::bit_cast<std::uint64_t>(value)); }
  void operator()(float value) noexcept { (*this)(std::bit_cast<std::uint32_t>(value)); }
  void operator()(const Vec3& v) noexcept { (*this)(v[0]), (*this)(v[1]), (*this)(v[2]); }
  /// Symmetric: xx, xy, xz, yy, yz, zz.
  void operator()(const Mat3& m) noexcept {
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) (*this)(m(i, j));
    }
  }
  template <class T, std::size_t N>
  void operator()(const std::array<T, N>& values) noexcept {
    for (const T& value : values) (*this)(value);
  }

  template <class T, class Limits>
  void operator()(const T& value, const Limits&) noexcept {
    (*this)(value);
  }

  std::size_t size() const noexcept { return at_; }

 private:
  std::span<std::byte> out_;
  std::size_t at_ = 0;
};

/// Takes fields from bytes somebody sent. Running out of bytes, or a number that is not finite, is remembered
/// and gives zeros; ask `complete` and `finite` at the end.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> in) : in_(in) {}

  template <class T>
  requires std::is_integral_v<T>
  void operator()(T& value) noexcept {
    value = 0;
    if (in_.size() - at_ < sizeof(T)) {
      complete_ = false;
      return;
    }
    std::make_unsigned_t<T> bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bits = static_cast<std::make_unsigned_t<T>>(
          bits | static_cast<std::make_unsigned_t<T>>(std::uint64_t{std::to_integer<std::uint8_t>(in_[at_++])}
                                                      << (8 * i)));
    }
    value = static_cast<T>(bits);
  }
  template <class T>
  requires std::is_enum_v<T>
  void operator()(T& value) noexcept {
    std::underlying_type_t<T> number = 0;
    (*this)(number);
    value = static_cast<T>(number);
  }
  void operator()(double& value) noexcept { read_real<std::uint64_t>(value); }
  void operator()(float& value) noexcept { read_real<std::uint32_t>(value); }
  void operator()(Vec3& v) noexcept { (*this)(v[0]), (*this)(v[1]), (*this)(v[2]); }
  void operator()(Mat3& m) noexcept {
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) (*this)(m(i, j)), m(j, i) = m(i, j);
    }
  }
  template <class T, std::size_t N>
  void operator()(std::array<T, N>& values) noexcept {
    for (T& value : values) (*this)(value);
  }

  /// Does not look at limits: `valid` does.
  template <class T, class Limits>
  void operator()(T& value, const Limits&) noexcept {
    (*this)(value);
  }

  std::size_t used() const noexcept { return at_; }
  bool complete() const noexcept { return complete_; }
  bool finite() const noexcept { return finite_; }

 private:
  template <class Bits, class Real>
  void read_real(Real& value) noexcept {
    Bits bits = 0;
    (*this)(bits);
    value = std::bit_cast<Real>(bits);
    if (!std::isfinite(value)) {
      value = 0;
      finite_ = false;
    }
  }

  std::span<const std::byte> in_;
  std::size_t at_ = 0;
  bool complete_ = true, finite_ = true;
};

}  // namespace palpate::protocol
