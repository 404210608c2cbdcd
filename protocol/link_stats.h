#pragma once
#include <array>
#include <cstdint>

#include "protocol/codec.h"

namespace palpate::protocol {

/// Counters of one end of a link. Written by its network thread; read after that thread ended.
struct LinkStats {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;     ///< accepted datagrams of the session, without duplicates
  std::uint64_t lost = 0;         ///< sequence numbers that never came (so far), of any kind
  std::uint64_t values_lost = 0;  ///< of these, samples in the client and tool states in the server
  std::uint64_t reordered = 0;    ///< came after a later one
  std::uint64_t overtaken = 0;    ///< of these, values dropped, as a newer one was there
  std::uint64_t duplicated = 0;   ///< came again, or too late to tell; dropped
  std::uint64_t implausible = 0;  ///< sequence number, or that of the value, far from those before; dropped
  std::uint64_t began_anew = 0;   ///< times that the numbers of the sender went on elsewhere
  std::uint64_t rejected = 0;     ///< not decodable, not authentic, or of no session we know
  std::array<std::uint64_t, kVerdicts> rejected_by{};  ///< of those, by the reason

  void reject(Verdict why) noexcept {
    ++rejected;
    ++rejected_by[static_cast<std::size_t>(why)];
  }
};

}  // namespace palpate::protocol
