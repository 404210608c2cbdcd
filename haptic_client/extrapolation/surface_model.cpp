#include "haptic_client/extrapolation/surface_model.h"

#include <algorithm>
#include <cmath>

namespace palpate::client {
using protocol::SurfacePage;
using protocol::SurfacePages;
using protocol::ToolState;

namespace {

constexpr SurfacePages kLargest{SurfaceModel::kMostVertices, 2 * SurfaceModel::kMostVertices};
constexpr double kComplete_ = 2e-3;  // m
/// The clock of asking: it may run over, differences are right.
std::uint32_t to_ms(Time t) {
  return static_cast<std::uint32_t>(t.count() / 1'000'000);
}
constexpr std::size_t kRequested = 4096;  // pages remembered; 200 are asked for in that time

}  // namespace

SurfaceModel::SurfaceModel()
    : shape_known_(kLargest.first_tile()), tiles_(kRoom), requested_(kRequested), near_(kLargest.vertices) {
  rest_.reserve(kLargest.vertices);
  triangles_.reserve(kLargest.triangles);
  spectrum_.reserve(kMaxPublishedModes);
}

void SurfaceModel::announce(const protocol::SurfaceState& state, std::uint32_t modes) noexcept {
  if (state.version == version_ && (version_ == 0 || modes == pages_.modes)) return;
  ++generation_;
  version_ = 0;
  if (state.vertices == 0 || state.vertices > kLargest.vertices || state.triangles > kLargest.triangles ||
      modes > kMaxPublishedModes)
    return;
  version_ = state.version;
  pages_ = {state.vertices, state.triangles, modes};
  spectrum_.clear();
  rest_.assign(state.vertices, Vec3::Zero());
  triangles_.assign(state.triangles, {});
  shape_missing_ = pages_.first_tile();
  std::ranges::fill(shape_known_, 0);
  slots_.clear();
  std::ranges::fill(requested_, Requested{});
  for (Tile& tile : tiles_) tile.page = 0;
  complete_at_.reset();
}

void SurfaceModel::take(const SurfacePage& page) noexcept {
  if (version_ == 0 || page.version != version_) return;
  if ((page.page & SurfacePages::kNotYet) != 0) {
    Requested& requested = requested_[(page.page & ~SurfacePages::kNotYet) % kRequested];
    requested.not_yet = requested.page == (page.page & ~SurfacePages::kNotYet);
    return;
  }
  if (page.page >= pages_.count()) return;
  if (Requested& requested = requested_[page.page % kRequested]; requested.page == page.page) requested = {};
  if (pages_.modes > 0 && page.page == pages_.spectrum()) {
    take_spectrum(page);
  } else if (page.page >= pages_.first_tile()) {
    take_tile(page);
  } else if (shape_known_[page.page] == 0) {
    take_shape(page);
  }
}

void SurfaceModel::take_shape(const SurfacePage& page) noexcept {
  const bool positions = page.page < pages_.first_triangle_page();
  const std::size_t first =
      (positions ? page.page : page.page - pages_.first_triangle_page()) * SurfacePages::kPerPage;
  const std::size_t size = positions ? rest_.size() : triangles_.size();
  for (std::size_t i = 0; i < SurfacePages::kPerPage && first + i < size; ++i) {
    const float* const three = &page.values[3 * i];
    if (positions) {
      rest_[first + i] = Eigen::Map<const Eigen::Vector3f>(three).cast<double>();
      continue;
    }
    for (int corner = 0; corner < 3; ++corner) {
      if (!(three[corner] >= 0 && three[corner] < static_cast<float>(rest_.size())))
        return;  // no such vertex
      triangles_[first + i][corner] = static_cast<int>(three[corner]);
    }
  }
  shape_known_[page.page] = 1;
  if (--shape_missing_ == 0) complete_shape();
}

void SurfaceModel::complete_shape() noexcept {
  near_.take(rest_);
  longest_edge_ = 0;
  for (const auto& t : triangles_) {
    for (int i = 0; i < 3; ++i)
      longest_edge_ = std::max(longest_edge_, (rest_[t[i]] - rest_[t[(i + 1) % 3]]).norm());
  }
}

void SurfaceModel::take_tile(const SurfacePage& page) noexcept {
  if (slots_.find(page.page) != PageSlots::kNone) return;
  Tile& tile = tiles_[next_slot_];
  if (tile.page != 0) {
    slots_.erase(tile.page);
    complete_at_.reset();
  }
  tile.page = page.page;
  tile.values = page.values;
  slots_.put(page.page, static_cast<std::uint16_t>(next_slot_));
  next_slot_ = (next_slot_ + 1) % tiles_.size();
}

void SurfaceModel::take_spectrum(const SurfacePage& page) noexcept {
  spectrum_.clear();
  for (std::size_t k = 0; k < pages_.modes; ++k) {
    const Mode mode{static_cast<double>(page.values[3 * k]), static_cast<double>(page.values[3 * k + 1])};
    // Else no such motion, or none that a client can follow.
    const bool slow = mode.frequency > 0 && mode.frequency <= 1.001 * kFastestPublishedMode;
    if (!slow || !(mode.damping >= 0 && mode.damping <= 1.001 * kMaxPublishedDamping))
      return spectrum_.clear();
    spectrum_.push_back(mode);
  }
}

bool SurfaceModel::add_shapes(int vertex, double weight, std::span<Vec3> shapes) const noexcept {
  constexpr std::uint32_t kModes = SurfacePages::kModes;
  const auto v = static_cast<std::uint32_t>(vertex), cluster = v / SurfacePages::kCluster;
  for (std::uint32_t group = 0; group < pages_.groups(); ++group) {
    const std::uint16_t slot = slots_.find(pages_.shapes(cluster, group));
    if (slot == PageSlots::kNone) return false;
    const float* const first =
        &tiles_[slot].values[static_cast<std::size_t>(3 * (v % SurfacePages::kCluster) * kModes)];
    const std::uint32_t count = std::min(kModes, pages_.modes - group * kModes);
    for (std::uint32_t k = 0; k < count; ++k) {
      const Eigen::Vector3f shape(first[k], first[kModes + k], first[2 * kModes + k]);
      shapes[group * kModes + k] += weight * shape.cast<double>();
    }
  }
  return true;
}

std::optional<Mat3> SurfaceModel::compliance(int i, int j) const noexcept {
  constexpr int kCluster = SurfacePages::kCluster;
  const auto a = static_cast<std::uint32_t>(i / kCluster), b = static_cast<std::uint32_t>(j / kCluster);
  if (a < b) {
    const auto other = compliance(j, i);
    return other ? std::optional<Mat3>(other->transpose()) : std::nullopt;
  }
  const std::uint16_t slot = slots_.find(pages_.tile(a, b));
  if (slot == PageSlots::kNone) return {};
  using Block = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
  const float* const first = &tiles_[slot].values[3 * (i % kCluster) * 3 * kCluster + 3 * (j % kCluster)];
  return Eigen::Map<const Block, 0, Eigen::OuterStride<3 * kCluster>>(first).cast<double>();
}

/// Collects pages to ask for.
class SurfaceModel::PageRequests {
 public:
  PageRequests(std::span<std::uint32_t> pages, std::vector<Requested>& requested, Time now, Time patience)
      : pages_(pages), requested_(requested), now_ms_(to_ms(now) + 1), patience_ms_(to_ms(patience)) {
    std::ranges::fill(pages, ToolState::kNoPage);
  }
  bool full() const { return count_ == pages_.size(); }
  bool any() const { return count_ > 0; }
  /// Notes that this page, which is missing, has been requested.
  void add(std::uint32_t page) {
    missing = true;
    Requested& requested = requested_[page % kRequested];
    const bool same = requested.page == page,
               waits = requested.ms != 0 && now_ms_ - requested.ms < patience_ms_;
    if (full() || (waits && (same || !requested.not_yet))) return;  // two pages may share a record: in turn
    const bool once_more = same && requested.ms != 0 && !requested.not_yet;
    again += once_more ? 1 : 0;
    requested = {page, now_ms_, false, once_more};
    pages_[count_++] = page;
  }
  bool missing = false;     ///< something is, asked for or not
  std::uint64_t again = 0;  ///< of those chosen, asked for before

 private:
  std::span<std::uint32_t> pages_;
  std::vector<Requested>& requested_;
  std::uint32_t now_ms_, patience_ms_;
  std::size_t count_ = 0;
};

bool SurfaceModel::choose_missing(const Vec3& p, double reach, Time now, std::span<std::uint32_t> pages,
                                  Time patience) noexcept {
  PageRequests requests(pages, requested_, now, patience);
  const bool any = choose(p, reach, requests);
  requested_again_ += requests.again;
  return any;
}

bool SurfaceModel::choose(const Vec3& p, double reach, PageRequests& requests) noexcept {
  if (version_ == 0 || !p.allFinite()) return false;
  for (std::uint32_t page = 0; shape_missing_ > 0 && page < pages_.first_tile(); ++page) {
    if (shape_known_[page] == 0) requests.add(page);
  }
  if (pages_.modes > 0 && spectrum_.empty()) requests.add(pages_.spectrum());
  if (requests.missing) return requests.any();
  if (complete_at_ && (*complete_at_ - p).norm() < kComplete_) return false;
  near_.search(p);
  near_.for_pairs(reach, [&](std::uint32_t a, std::uint32_t b) {
    pages_.for_clusters(a, b, [&](std::uint32_t page) {
      if (slots_.find(page) == PageSlots::kNone) requests.add(page);
    });
    return !requests.full();
  });
  if (!requests.missing) complete_at_ = p;
  return requests.any();
}

std::optional<Time> SurfaceModel::waited_for(std::uint32_t page, Time now) const noexcept {
  page &= ~SurfacePages::kNotYet;
  const Requested& requested = requested_[page % kRequested];
  if (requested.page != page || requested.ms == 0 || requested.again) return {};
  return std::chrono::milliseconds(to_ms(now) + 1 - requested.ms);
}

}  // namespace palpate::client
