#pragma once
#include <string>

#include "common/histogram.h"
#include "common/time.h"
#include "protocol/messages.h"

namespace palpate::client {

/// Figures of the link that a session needs, and gets. Written by the network thread; read when that has
/// ended.
struct LinkFigures {
  Histogram age_ns;  ///< of each sample when it arrived: since its tool position was read
  std::uint64_t samples = 0, pages = 0;
  std::uint64_t bytes_up = 0, bytes_down = 0;    ///< of UDP's payload
  std::uint64_t early_bytes_down = 0;            ///< of these, in the first second after the first
  Time began{};                                  ///< when the first datagram came
  Time newest_sample{}, longest_gap{};           ///< when it came; between two samples that came
  std::uint64_t gaps = 0;                        ///< of more than `kGap`
  std::uint64_t surfaces = 0;                    ///< samples that name a surface, so that its pages can come
  std::uint64_t page_requests = 0;               ///< datagrams that requested pages
  std::uint64_t unanswered = 0;                  ///< of these, one in `kEvery`, since the newest page came
  Time first_unanswered{}, newest_unanswered{};  ///< when the first and the newest of these left
  protocol::UplinkCounts uplink{};               ///< as the server told them last; none: it does not
  double stiffest = 0;  ///< N/m: of all samples in contact, how much force a metre into the surface makes

  static constexpr Time kGap = std::chrono::milliseconds(100);  ///< three samples at 30 Hz

  void sent(std::size_t bytes) noexcept { bytes_up += bytes; }
  void received(std::size_t bytes, Time now) noexcept;
  void sample(const protocol::ForceSample& sample, Time now) noexcept;
  void page() noexcept;
  void requested_pages(Time now) noexcept;
  /// True if samples come while no page of those requested has come in `kPatience`, at any time of the
  /// session: pages are its largest datagrams, so that the way drops large ones. Until a page comes.
  bool drops_large() const noexcept;
  static constexpr Time kPatience = std::chrono::seconds(3);
  /// Requests within it count as one: a burst of them on a long way is not answered at once.
  static constexpr Time kEvery = std::chrono::milliseconds(200);
};

/// Returns what is known of a way that drops large datagrams, and what helps; a sentence.
std::string large_datagrams_text();

}  // namespace palpate::client
