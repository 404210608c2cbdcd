#pragma once
#include <atomic>
#include <deque>
#include <functional>
#include <span>

#include "common/time.h"
#include "common/triple_buffer.h"
#include "sim_server/viewer/picture.h"

namespace palpate::sim {

/// Between the threads of a session and the page's thread: the newest picture, and what pages ask for. Nobody
/// waits for anybody.
class ViewerFeed {
 public:
  /// `rest`: (n) of the surface, m, which is shown until the first picture comes.
  /// `nodes`: (k) of the mesh, where what is inside can be shown, else none.
  explicit ViewerFeed(std::span<const Vec3> rest, std::span<const Vec3> nodes_at_rest = {})
      : pictures(shown_first(rest)), nodes(std::vector<Vec3>(nodes_at_rest.begin(), nodes_at_rest.end())) {}

  /// Simulation thread to page's thread; `back` holds an old picture, to be overwritten whole.
  TripleBuffer<Picture> pictures;
  /// (k) of the mesh, m: the same way, while `requests_field`.
  TripleBuffer<std::vector<Vec3>> nodes;
  /// Data that the page's thread fills in itself, of each tool, in `hooks.events`.
  std::array<SeenPeer, kMaxTools> peers{};
  std::array<SeenClient, kMaxTools> clients{};
  std::array<std::uint64_t, kMaxTools> client_events{};  ///< how many came so far
  std::deque<ClientTicks> ticks;                         ///< taken out when they are shown
  /// Set before anything runs, called by the page's thread; empty: there is nobody to ask or to tell.
  struct Hooks {
    std::function<void(Time now)> events;
    std::function<void(const PagePointer&)> point;
    /// Computes the colour values of the surface, J/m3 of each of its vertices, for these node positions (m).
    std::function<void(std::span<const Vec3> nodes, std::vector<float>& values)> field;
  } hooks;

  /// Requests of pages; written by the page's thread. Any thread may read.
  std::atomic<int> pages{0};  ///< how many are open: with none, nobody needs to fill anything in
  std::atomic<bool> requests_field{false};  ///< one of them colours the organ by what is inside
  std::atomic<bool> paused{false};          ///< no steps but those of `steps`
  std::atomic<int> steps{0};                ///< to be made while paused; who makes one takes it off
  std::atomic<int> chosen{-1};              ///< of `SceneFacts::gallery`

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
