#pragma once
#include <cmath>

namespace palpate::emulation {

/// A vector of three, kept apart from the program's own algebra: the emulator shares no code with what it
/// tests.
struct Vec {
  double x = 0, y = 0, z = 0;

  Vec& operator+=(const Vec& o) { return *this = {x + o.x, y + o.y, z + o.z}; }
  friend Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec operator*(double s, const Vec& v) { return {s * v.x, s * v.y, s * v.z}; }
  friend double dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend double norm(const Vec& v) { return std::sqrt(dot(v, v)); }
};

}  // namespace palpate::emulation
