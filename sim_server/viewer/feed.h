#pragma once
#include <atomic>
#include <span>

#include "common/latest_value.h"
#include "common/spsc_ring.h"
#include "sim_server/viewer/picture.h"

namespace palpate::sim {

/// Between the threads of a session and the page's thread: newest values, and what pages ask for. Nobody
/// waits for anybody. All memory is taken when it is made.
class ViewerFeed {
 public:
  /// `rest`: (n) of the surface, m, which is shown until the first picture comes.
  explicit ViewerFeed(std::span<const Vec3> rest) : pictures(shown_first(rest)) {}

  /// Simulation thread to page's thread; `back` holds an old picture, to be overwritten whole.
  TripleBuffer<Picture> pictures;
  /// Network thread to page's thread, of each tool.
  std::array<LatestValue<SeenPeer>, kMaxTools> peers;
  std::array<LatestValue<SeenClient>, kMaxTools> clients;
  SpscRing<ClientTicks> ticks{64};

  /// What pages want; written by the page's thread. Any thread may read.
  std::atomic<int> pages{0};        ///< how many are open: with none, nobody needs to fill anything in
  std::atomic<bool> paused{false};  ///< no steps but those of `steps`
  std::atomic<int> steps{0};        ///< to be made while paused; who makes one takes it off
  std::atomic<int> chosen{-1};      ///< of `SceneFacts::gallery`
  std::array<LatestValue<PagePointer>, kMaxTools> pointers;  ///< for one reader

 private:
  static Picture shown_first(std::span<const Vec3> rest) {
    Picture picture;
    for (const Vec3& p : rest) {
      for (int i = 0; i < 3; ++i) picture.positions.push_back(static_cast<float>(p[i]));
    }
    return picture;
  }
};

}  // namespace palpate::sim
