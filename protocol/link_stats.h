#pragma once
#include <array>
#include <cstdint>

#include "protocol/codec.h"

namespace palpate::protocol {

/// Counters of one end of a link. Written by its network thread; read after that thread ended.
struct LinkStats {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;    ///< accepted datagrams of the session, without duplicates
  std::uint64_t lost = 0;        ///< sequence numbers that never came (so far)
  std::uint64_t reordered = 0;   ///< came after a later one
  std::uint64_t duplicated = 0;  ///< came again, or too late to tell; dropped
  std::uint64_t began_anew = 0;  ///< times that the numbers of the sender went on elsewhere
  std::uint64_t rejected = 0;    ///< not decodable, or of no session we know
  std::array<std::uint64_t, kVerdicts> rejected_by{};  ///< of those, per verdict of the codec
};

}  // namespace palpate::protocol
