#include "sim_server/viewer/page_requests.h"

#include <algorithm>

#include "protocol/auth.h"

namespace palpate::sim {

bool PageRequests::obey(PageLink& link, const PageMessage& message) {
  if (const auto* hello = std::get_if<PageHello>(&message)) {
    if (link.greeted()) return false;
    link.greet(!token.empty() && protocol::equal_in_constant_time(hello->token, token));
    return true;
  }
  if (!link.greeted()) return false;
  if (const auto* want = std::get_if<PageWant>(&message)) {
    const bool known = std::ranges::find(scene.fields, want->field) != scene.fields.end();
    if (!want->field.empty() && !known) link.refuse("this scene cannot be coloured by " + want->field);
    link.want_field(known);
  } else if (const auto* shown = std::get_if<PageShown>(&message)) {
    link.shown(shown->step);
  } else if (link.may_control()) {
    control(link, message);
  } else {
    link.refuse("this page may only look on; who has the address with the token may do more");
  }
  return true;
}

void PageRequests::control(PageLink& link, const PageMessage& message) {
  if (const auto* pause = std::get_if<PagePause>(&message)) {
    if (!scene.pausable) return link.refuse("this session cannot be paused");
    feed.steps = 0;
    feed.paused = pause->paused;
  } else if (std::holds_alternative<PageStep>(message)) {
    if (!feed.paused) return link.refuse("single steps are made while paused");
    ++feed.steps;
  } else if (const auto* pointer = std::get_if<PagePointer>(&message)) {
    if (pointer->tool >= scene.tools.size()) return link.refuse("the scene has no such tool");
    if (!feed.hooks.point) return link.refuse("no mouse moves a tool here");
    link.pointed(*pointer);
    feed.hooks.point(*pointer);
  } else if (const auto* choose = std::get_if<PageChoose>(&message)) {
    const auto found = std::ranges::find(scene.gallery, choose->scene);
    if (found == scene.gallery.end()) return link.refuse("no scene of that name can be chosen here");
    feed.chosen = static_cast<int>(found - scene.gallery.begin());
  }
}

}  // namespace palpate::sim
