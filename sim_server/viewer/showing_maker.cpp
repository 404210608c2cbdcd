#include "sim_server/viewer/showing_maker.h"

namespace palpate::sim {
namespace {

constexpr Time kMeasuredOver = std::chrono::seconds(1);    // rates of steps
constexpr Time kMarkEach = std::chrono::milliseconds(40);  // 26 marks in that second
constexpr double kMeasuredAtLeast = 0.4;                   // s

}  // namespace

ShowingMaker::ShowingMaker(const SceneFacts& scene, ViewerFeed& feed, bool live) : feed_(feed) {
  const std::size_t tools = scene.tools.size();
  showing_.scene = &scene;
  showing_.live = live;
  showing_.box = view_box(scene.organ.rest);
  showing_.picture = &feed.pictures.front();
  showing_.pictures = 1;
  showing_.positions.resize(3 * scene.organ.rest.size());
  quantise(showing_.box, showing_.picture->positions, showing_.positions);
  showing_.peers.resize(tools);
  showing_.clients.resize(tools);
  showing_.client_events.resize(tools);
  showing_.ticks.resize(Showing::kTicksStored);
}

void ShowingMaker::update(Time now) {
  if (feed_.pictures.take()) {
    showing_.picture = &feed_.pictures.front();
    ++showing_.pictures;
    quantise(showing_.box, showing_.picture->positions, showing_.positions);
    showing_.version = Showing::kCompleteSurface + showing_.picture->cuts;
    showing_.triangles = showing_.picture->triangles;
    fresh_ = true;
  }
  if (feed_.hooks.events) feed_.hooks.events(now);
  for (std::size_t i = 0; i < showing_.peers.size(); ++i) {
    showing_.peers[i] = feed_.peers[i];
    showing_.clients[i] = feed_.clients[i];
    showing_.client_events[i] = feed_.client_events[i];
  }
  for (; !feed_.ticks.empty(); feed_.ticks.pop_front())
    showing_.ticks[showing_.ticks_so_far++ % Showing::kTicksStored] = feed_.ticks.front();
  if (feed_.nodes.take() && feed_.hooks.field) {
    feed_.hooks.field(feed_.nodes.front(), showing_.field);
    ++showing_.fields;
  }
  showing_.paused = feed_.paused;
  measure(now);
}

void ShowingMaker::measure(Time now) {
  const Picture& picture = *showing_.picture;
  if (feed_.pages == 0) fresh_ = false;
  if (!fresh_) marks_.clear();
  showing_.rates = {};
  if (!fresh_) return;
  if (marks_.empty() || now - marks_.back().t >= kMarkEach)
    marks_.push_back({now, picture.step, picture.simulated});
  while (marks_.size() > 2 && now - marks_.front().t > kMeasuredOver) marks_.pop_front();
  const double seconds = to_seconds(marks_.back().t - marks_.front().t);
  if (seconds < kMeasuredAtLeast) return;
  showing_.rates = {static_cast<double>(marks_.back().step - marks_.front().step) / seconds,
                    (marks_.back().simulated - marks_.front().simulated) / seconds};
}

}  // namespace palpate::sim
