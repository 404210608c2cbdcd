#pragma once
#include <optional>
#include <span>
#include <vector>

#include "common/time.h"
#include "common/types.h"
#include "haptic_client/extrapolation/page_slots.h"
#include "protocol/near_tiles.h"

namespace palpate::client {

/// Model of the surface that the tool can reach, as known to the client. It holds its shape at rest and its
/// compliance, as they come in pages from the server (protocol/surface_pages.h), and the slow modes of a body
/// in motion. It finds the missing pages, the nearest first; it stores those near the tool, and drops the
/// oldest. Only the constructor allocates, 11 MB whatever the size of the surface. Haptic thread.
class SurfaceModel {
 public:
  static constexpr std::size_t kMostVertices = protocol::kMostSurfaceVertices;  ///< of a model that it takes
  static constexpr std::size_t kRoom = protocol::NearTiles::kStored;  ///< tiles and shapes, 900 bytes each

  SurfaceModel();

  /// Takes the state of the model on the server; another version clears all pages. Call it with every sample
  /// that has one.
  void announce(const protocol::SurfaceState& state, std::uint32_t modes = 0) noexcept;
  /// A page came, or that it will be known later; one of another version changes nothing.
  void take(const protocol::SurfacePage& page) noexcept;

  /// Writes into `pages` what to ask for at time `now`, for a tool at `p` (m, at rest): the shape, then the
  /// compliance between all that lies within `reach` (m) of it, then farther around. What was asked for in
  /// the last `patience` is not asked for again. Entries without a wish are `ToolState::kNoPage`; false when
  /// all are. About 15 us where the tool has come to something new, else nothing.
  bool choose_missing(const Vec3& p, double reach, Time now, std::span<std::uint32_t> pages,
                      Time patience = std::chrono::milliseconds(200)) noexcept;
  /// Returns the time at `now` since a page was requested, to a millisecond; nothing where it was not
  /// requested, was requested more than once, or where that request was dropped.
  std::optional<Time> waited_for(std::uint32_t page, Time now) const noexcept;
  /// Returns how many pages were requested once more, as no answer had come.
  std::uint64_t requested_again() const noexcept { return requested_again_; }

  /// Version 0: none is known.
  std::uint32_t version() const noexcept { return version_; }
  /// Another number for each model that was announced, also if it is the same again.
  std::uint64_t generation() const noexcept { return generation_; }
  /// True if the shape of the surface is complete.
  bool has_shape() const noexcept { return version_ != 0 && shape_missing_ == 0; }
  std::span<const Vec3> rest() const noexcept { return rest_; }
  std::span<const std::array<int, 3>> triangles() const noexcept { return triangles_; }
  /// No edge of a triangle is longer, m.
  double longest_edge() const noexcept { return longest_edge_; }
  /// The slow modes that the tissue swings in; empty: it does not, or they are not known yet.
  struct Mode {
    double frequency = 0, damping = 0;  ///< rad/s, 1/s
  };
  std::span<const Mode> spectrum() const noexcept { return spectrum_; }
  /// Adds `weight` times how a vertex moves in each mode (1/sqrt(kg)) to `shapes`; false where that is not
  /// known, then to some of them.
  bool add_shapes(int vertex, double weight, std::span<Vec3> shapes) const noexcept;
  /// Returns the displacement of vertex i per force on vertex j, m/N; nothing where that is not known.
  std::optional<Mat3> compliance(int i, int j) const noexcept;

 private:
  struct Tile {
    std::uint32_t page = 0;  // 0: empty; that page is one of the shape
    std::array<float, protocol::SurfacePage::kValues> values{};
  };
  struct Requested {
    std::uint32_t page = protocol::ToolState::kNoPage, ms = 0;
    bool not_yet = false;  // said the server
    bool again = false;    // asked for more than once
  };
  void take_shape(const protocol::SurfacePage& page) noexcept;
  void complete_shape() noexcept;
  void take_tile(const protocol::SurfacePage& page) noexcept;
  void take_spectrum(const protocol::SurfacePage& page) noexcept;
  class PageRequests;
  bool choose(const Vec3& p, double reach, PageRequests& requests) noexcept;

  protocol::SurfacePages pages_;
  std::uint32_t version_ = 0, shape_missing_ = 0;
  std::uint64_t generation_ = 0;
  std::vector<Vec3> rest_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<char> shape_known_;  // by page
  std::vector<Mode> spectrum_;
  double longest_edge_ = 0;
  PageSlots slots_{kRoom};  // of tiles
  std::vector<Tile> tiles_;
  std::size_t next_slot_ = 0;
  std::vector<Requested>
      requested_;  // by page, several of which share a place: the last one that was asked for
  std::uint64_t requested_again_ = 0;
  protocol::NearTiles near_;
  std::optional<Vec3> complete_at_;  // a place for which nothing was missing
};

}  // namespace palpate::client
