#pragma once
/// The binary messages to a page, byte by byte: MESSAGES.md. No clock, no socket.
#include <span>

#include "sim_server/viewer/picture.h"

namespace palpate::sim {

using Bytes = std::vector<std::byte>;

/// Box of positions of 16 bits a coordinate: min + size q / 65535, m.
struct ViewBox {
  std::array<float, 3> min{}, size{};
};

/// Around the organ at rest, with half of its diagonal to each side, for it to move in. Each size is above 0.
ViewBox view_box(std::span<const Vec3> rest);

/// Each of `positions` (3 n, m) as 16 bits, to within half of size / 65535; what lies outside, or is no
/// number, on the box's wall. O(n); no allocation.
void quantise(const ViewBox& box, std::span<const float> positions, std::span<std::uint16_t> out) noexcept;

/// Each replaces `out`.
void write_topology(const OrganShape& organ, const ViewBox& box, std::uint32_t version, Bytes& out);

/// Which surface, and when.
struct SurfaceStamp {
  std::uint32_t version = 0, step = 0;
  double t = 0;  ///< s
};
/// Writes the moved vertices: those of `now` (3 n) that differ from `had`, and updates `had`. `complete`:
/// writes all of them; also where `had` is shorter.
void write_surface(const SurfaceStamp& stamp, std::span<const std::uint16_t> now,
                   std::span<std::uint16_t> had, bool complete, Bytes& out);

/// The triangles of another version of the topology: those of `now` that `had`, which follows, has not got in
/// the same place; `complete`: all of them, also where that is shorter.
void write_triangles(std::uint32_t version, std::span<const Triangle> now, std::vector<Triangle>& had,
                     bool complete, Bytes& out);

/// `missed`: samples since the last one that this page got, which it did not.
void write_sample(std::uint8_t tool, std::uint16_t missed, const SeenTool::Sample& sample, Bytes& out);
void write_ticks(const ClientTicks& ticks, Bytes& out);

/// `values` (n), J/m3 and not below 0, each as its share of the largest.
void write_field(std::uint32_t version, std::span<const float> values, Bytes& out);

}  // namespace palpate::sim
