#include "sim_server/viewer/page_link.h"

#include <algorithm>
#include <utility>

namespace palpate::sim {
namespace {

PageLink::Kind put_text(const std::string& text, Bytes& out) {
  const auto bytes = std::as_bytes(std::span(text));
  out.assign(bytes.begin(), bytes.end());
  return PageLink::Kind::kText;
}

}  // namespace

std::optional<PageLink::Kind> PageLink::next(const Showing& showing, Time now, Bytes& out) {
  if (!greeted_) return {};
  if (!refused_.empty()) {
    const std::string why = std::exchange(refused_, {});
    return put_text(refused_text(why), out);
  }
  if (const auto kind = begin(showing, out)) return kind;
  if (!showing.live) return {};
  if (now - state_at_ >= kStateEach || (received_.state != showing.pictures && may_follow(now - state_at_))) {
    received_.state = showing.pictures;
    state_at_ = now;
    return put_text(state_text(*showing.picture, showing.peers, showing.rates, showing.paused), out);
  }
  if (next_surface(showing, now, out) || next_sample(showing, out)) return Kind::kBinary;
  Kind kind = Kind::kBinary;
  if (next_of_client(showing, out, kind)) return kind;
  if (requests_field_ && received_.field != showing.fields && !showing.field.empty()) {
    received_.field = showing.fields;
    write_field(showing.version, showing.field, out);
    return Kind::kBinary;
  }
  return {};
}

/// Returns what comes before anything else.
std::optional<PageLink::Kind> PageLink::begin(const Showing& showing, Bytes& out) {
  if (!knows_scene_) {
    knows_scene_ = true;
    return put_text(scene_text(*showing.scene, may_control_), out);
  }
  if (!showing.live || showing.positions.empty()) return {};
  if (received_.version == 0) {
    received_.version = Showing::kCompleteSurface;
    received_.surface = received_.state = 0;
    received_.positions.clear();
    write_topology(showing.scene->organ, showing.box, received_.version, out);
    return Kind::kBinary;
  }
  if (received_.version == showing.version && !complete_triangles_) return {};
  if (received_.version == Showing::kCompleteSurface) received_.triangles = showing.scene->organ.triangles;
  received_.version = showing.version;
  write_triangles(received_.version, showing.triangles, received_.triangles,
                  std::exchange(complete_triangles_, false), out);
  return Kind::kBinary;
}

bool PageLink::next_surface(const Showing& showing, Time now, Bytes& out) {
  if (received_.surface == showing.pictures || !may_follow(now - surface_at_) || showing.positions.empty())
    return false;
  const bool complete = received_.positions.empty();
  if (complete) received_.positions.resize(showing.positions.size());
  const Picture& picture = *showing.picture;
  write_surface({showing.version, static_cast<std::uint32_t>(picture.step), picture.t}, showing.positions,
                received_.positions, complete, out);
  received_.surface = showing.pictures;
  surface_at_ = now;
  // The same step may be shown again, as when a page opens while paused: it is sent once.
  const auto step = static_cast<std::uint32_t>(picture.step);
  if (acknowledges_ && (in_transit_.empty() || in_transit_.back() != step)) in_transit_.push_back(step);
  return true;
}

/// True if the next picture may be shown, so long after the last.
bool PageLink::may_follow(Time after) const noexcept {
  return after >= kSurfaceEach && in_transit_.size() < kMaxInTransit;
}

void PageLink::shown(std::uint32_t step) noexcept {
  acknowledges_ = true;
  const auto found = std::find(in_transit_.rbegin(), in_transit_.rend(), step);
  in_transit_.erase(in_transit_.begin(), found.base());
}

void PageLink::pointed(const PagePointer& pointer) {
  std::erase_if(pressed_, [&](const PagePointer& before) { return before.tool == pointer.tool; });
  if (pointer.buttons != 0) pressed_.push_back(pointer);
}

std::vector<PagePointer> PageLink::released() const {
  std::vector<PagePointer> released = pressed_;
  for (PagePointer& pointer : released) pointer.buttons = 0;
  return released;
}

bool PageLink::next_sample(const Showing& showing, Bytes& out) {
  for (std::size_t i = 0; i < showing.scene->tools.size(); ++i) {
    const SeenTool::Sample& sample = showing.picture->tools[i].sample;
    if (sample.number == 0 || sample.number == received_.samples[i]) continue;
    const std::uint64_t before = std::exchange(received_.samples[i], sample.number),
                        missed = before > 0 && sample.number > before ? sample.number - before - 1 : 0;
    write_sample(static_cast<std::uint8_t>(i),
                 static_cast<std::uint16_t>(std::min<std::uint64_t>(missed, 65535)), sample, out);
    return true;
  }
  return false;
}

bool PageLink::next_of_client(const Showing& showing, Bytes& out, Kind& kind) {
  for (std::size_t i = 0; i < showing.clients.size(); ++i) {
    if (showing.client_events[i] == received_.clients[i] || !showing.peers[i].held) continue;
    received_.clients[i] = showing.client_events[i];
    kind = put_text(client_text(showing.clients[i]), out);
    return true;
  }
  if (received_.ticks == showing.ticks_so_far) return false;
  received_.ticks =
      std::max(received_.ticks,
               showing.ticks_so_far - std::min<std::uint64_t>(showing.ticks_so_far, Showing::kTicksStored));
  write_ticks(showing.ticks[received_.ticks % Showing::kTicksStored], out);
  ++received_.ticks;
  kind = Kind::kBinary;
  return true;
}

}  // namespace palpate::sim
