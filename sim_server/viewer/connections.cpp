#include "sim_server/viewer/connections.h"

#include <algorithm>

namespace palpate::sim {

std::optional<Connections::Id> Connections::open(Id id, const std::string& address, Time now) {
  const auto of_address = [&](const Connection& c) { return c.address == address; };
  const bool address_full =
      std::ranges::count_if(all_, of_address) >= static_cast<std::ptrdiff_t>(kMostOfAddress);
  std::optional<Id> departing;
  if (address_full || all_.size() >= kMost) {
    auto oldest = all_.end();
    for (auto c = all_.begin(); c != all_.end(); ++c) {
      if (!c->silent_since || (address_full && !of_address(*c))) continue;
      if (oldest == all_.end() || *c->silent_since < *oldest->silent_since) oldest = c;
    }
    if (oldest == all_.end()) return id;
    departing = oldest->id;
    all_.erase(oldest);
  }
  all_.push_back({id, address, now});
  return departing;
}

void Connections::serve(Id id) noexcept {
  if (Connection* const c = find(id)) c->silent_since.reset();
}

void Connections::answered(Id id, Time now) noexcept {
  if (Connection* const c = find(id)) c->silent_since = now;
}

void Connections::closed(Id id) noexcept {
  std::erase_if(all_, [&](const Connection& c) { return c.id == id; });
}

std::optional<Connections::Id> Connections::take_silent(Time now) noexcept {
  const auto found = std::ranges::find_if(
      all_, [&](const Connection& c) { return c.silent_since && now - *c.silent_since > kSilence; });
  if (found == all_.end()) return {};
  const Id id = found->id;
  all_.erase(found);
  return id;
}

Connections::Connection* Connections::find(Id id) noexcept {
  const auto found = std::ranges::find_if(all_, [&](const Connection& c) { return c.id == id; });
  return found == all_.end() ? nullptr : &*found;
}

}  // namespace palpate::sim
