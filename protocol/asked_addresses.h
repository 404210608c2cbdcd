#pragma once
#include <array>
#include <utility>

#include "protocol/endpoint.h"

namespace palpate::protocol {

/// Which of our addresses the peers last sent to, where we are bound to all of them: answers must come from
/// there, or a client, and many a firewall, does not know them. Of the last few peers; no allocation.
class AskedAddresses {
 public:
  void note(const Endpoint& peer, const Endpoint& own) noexcept {
    for (auto& [known, address] : entries_)
      if (known == peer) {
        address = own;
        return;
      }
    entries_[next_++ % entries_.size()] = {peer, own};
  }
  /// Port 0: not known.
  Endpoint of(const Endpoint& peer) const noexcept {
    for (const auto& [known, address] : entries_)
      if (known == peer) return address;
    return {};
  }

 private:
  std::array<std::pair<Endpoint, Endpoint>, 16> entries_{};
  std::size_t next_ = 0;
};

}  // namespace palpate::protocol
