#include "sim_server/viewer/encoding.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace palpate::sim {
namespace {

enum class Kind : std::uint8_t {  // of a message: its first byte
  kTopology = 1,
  kSurface = 2,
  kTicks = 3,
  kSample = 4,
  kField = 5,
  kTriangles = 6,
};
constexpr double kMost = std::numeric_limits<std::uint16_t>::max();  // of a coordinate

static_assert(std::endian::native == std::endian::little, "the messages are little-endian");

template <class T>
void append(Bytes& out, const T& value) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof value);
}
template <class T>
void append_all(Bytes& out, std::span<const T> values) {
  const auto bytes = std::as_bytes(values);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

void begin(Bytes& out, Kind kind, std::uint8_t second = 0, std::uint8_t third = 0) {
  out.clear();
  out.insert(out.end(), {static_cast<std::byte>(kind), std::byte{second}, std::byte{third}, std::byte{0}});
}

bool same(std::span<const std::uint16_t> a, std::span<const std::uint16_t> b, std::size_t v) noexcept {
  return a[3 * v] == b[3 * v] && a[3 * v + 1] == b[3 * v + 1] && a[3 * v + 2] == b[3 * v + 2];
}

}  // namespace

ViewBox view_box(std::span<const Vec3> rest) {
  if (rest.empty()) return {{-1, -1, -1}, {2, 2, 2}};
  Vec3 least = Vec3::Constant(std::numeric_limits<double>::infinity()), most = -least;
  for (const Vec3& p : rest) {
    least = least.cwiseMin(p);
    most = most.cwiseMax(p);
  }
  const double room = std::max(0.5 * (most - least).norm(), 1e-6);
  ViewBox box;
  for (int i = 0; i < 3; ++i) {
    box.min[i] = static_cast<float>(least[i] - room);
    box.size[i] = static_cast<float>(most[i] - least[i] + 2 * room);
  }
  return box;
}

void quantise(const ViewBox& box, std::span<const float> positions, std::span<std::uint16_t> out) noexcept {
  std::array<double, 3> scale;
  for (std::size_t i = 0; i < 3; ++i) scale[i] = kMost / static_cast<double>(box.size[i]);
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const std::size_t i = k % 3;
    const double q = (static_cast<double>(positions[k]) - static_cast<double>(box.min[i])) * scale[i] + 0.5;
    out[k] = static_cast<std::uint16_t>(q > 0 ? std::min(q, kMost) : 0);  // 0 also of what is no number
  }
}

void write_topology(const OrganShape& organ, const ViewBox& box, std::uint32_t version, Bytes& out) {
  begin(out, Kind::kTopology);
  append(out, version);
  append(out, static_cast<std::uint32_t>(organ.rest.size()));
  append(out, static_cast<std::uint32_t>(organ.triangles.size()));
  append(out, box.min), append(out, box.size);
  for (const Vec3& p : organ.rest) {
    for (int i = 0; i < 3; ++i) append(out, static_cast<float>(p[i]));
  }
  for (const Triangle& triangle : organ.triangles) {
    for (const int corner : triangle) append(out, static_cast<std::uint32_t>(corner));
  }
  append_all<std::uint8_t>(out, organ.flags);
}

void write_surface(const SurfaceStamp& stamp, std::span<const std::uint16_t> now,
                   std::span<std::uint16_t> had, bool complete, Bytes& out) {
  const std::size_t n = now.size() / 3;
  std::size_t moved = 0;
  for (std::size_t v = 0; v < n; ++v) moved += same(now, had, v) ? 0 : 1;
  constexpr std::size_t kNumbered = sizeof(std::uint32_t) + 3 * sizeof(std::uint16_t);  // a vertex alone
  complete = complete || kNumbered * moved >= now.size_bytes();
  begin(out, Kind::kSurface);
  append(out, stamp.version), append(out, stamp.step), append(out, stamp.t);
  append(out, static_cast<std::uint32_t>(complete ? n : moved));
  append(out, static_cast<std::uint32_t>(complete ? 1 : 0));
  if (complete) {
    append_all(out, now);
  } else {
    for (std::size_t v = 0; v < n; ++v) {
      if (!same(now, had, v)) append(out, static_cast<std::uint32_t>(v));
    }
    for (std::size_t v = 0; v < n; ++v) {
      if (!same(now, had, v)) append_all(out, now.subspan(3 * v, 3));
    }
  }
  std::ranges::copy(now, had.begin());
}

void write_triangles(std::uint32_t version, std::span<const Triangle> now, std::vector<Triangle>& had,
                     bool complete, Bytes& out) {
  std::vector<std::uint32_t> places;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (i >= had.size() || now[i] != had[i]) places.push_back(static_cast<std::uint32_t>(i));
  }
  complete = complete || 4 * places.size() >= 3 * now.size();
  begin(out, Kind::kTriangles);
  append(out, version), append(out, static_cast<std::uint32_t>(now.size()));
  append(out, static_cast<std::uint32_t>(complete ? now.size() : places.size()));
  append(out, static_cast<std::uint32_t>(complete ? 1 : 0));
  if (complete) {
    append_all(out, now);
  } else {
    append_all<std::uint32_t>(out, places);
    for (const std::uint32_t i : places) append(out, now[i]);
  }
  had.assign(now.begin(), now.end());
}

void write_sample(std::uint8_t tool, std::uint16_t missed, const SeenTool::Sample& sample, Bytes& out) {
  begin(out, Kind::kSample, tool);
  out.resize(2);
  append(out, missed);
  append(out, sample.t), append(out, sample.force), append(out, sample.flags);
}

void write_ticks(const ClientTicks& ticks, Bytes& out) {
  begin(out, Kind::kTicks, ticks.tool, ticks.laws);
  append(out, ticks.count), append(out, ticks.t), append(out, ticks.dt);
  append_all(out, std::span(ticks.rendered).first(ticks.count));
  for (std::size_t k = 0; k < ticks.count; ++k) append_all(out, std::span(ticks.by_law[k]).first(ticks.laws));
}

void write_field(std::uint32_t version, std::span<const float> values, Bytes& out) {
  constexpr std::uint8_t kStrainEnergy = 1;  // the only field so far
  float largest = 0;
  for (const float value : values) largest = std::max(largest, value);
  begin(out, Kind::kField, kStrainEnergy);
  append(out, version), append(out, static_cast<std::uint32_t>(values.size())), append(out, largest);
  for (const float value : values)
    append(out, static_cast<std::uint8_t>(largest > 0 && value > 0 ? 255 * value / largest + 0.5F : 0));
}

}  // namespace palpate::sim
