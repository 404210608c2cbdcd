// Any bytes as what a browser says: names in its request, and messages of its page, after and before hello.
// What is taken is in range, and whatever it does, a page that takes all it is due comes to an end of that.
#include <cstdlib>
#include <string_view>

#include "sim_server/viewer/access.h"
#include "sim_server/viewer/showing_maker.h"

using namespace palpate;
using namespace palpate::sim;

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

/// A page that looks at a tetrahedron.
struct Session {
  SceneFacts scene = [] {
    SceneFacts facts;
    facts.tools.resize(2);
    facts.organ.rest = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    facts.organ.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    facts.organ.flags = {0, 0, 0, 0};
    return facts;
  }();
  ViewerFeed feed{scene.organ.rest};
  ShowingMaker maker{scene, feed, true};
  PageLink link{Time{}};
  Time time{};
  Bytes out;

  void take(const PageMessage& message) {
    if (const auto* hello = std::get_if<PageHello>(&message)) link.greet(hello->token == "token");
    if (const auto* want = std::get_if<PageWant>(&message)) link.want_field(!want->field.empty());
    if (const auto* shown = std::get_if<PageShown>(&message)) link.shown(shown->step);
    if (const auto* pointer = std::get_if<PagePointer>(&message))
      require(pointer->tool < kMaxTools && pointer->p_W.allFinite());
    if (const auto* choose = std::get_if<PageChoose>(&message)) link.refuse(choose->scene);
    if (std::holds_alternative<PageStep>(message)) {
      feed.pictures.back() = feed.pictures.front();
      feed.pictures.back().step += 1;
      feed.pictures.publish();
    }
    time += std::chrono::milliseconds(10);
    maker.update(time);
    int messages = 0;
    while (link.next(maker.showing(), time, out)) require(++messages < 20);
  }
};

}  // namespace

/// Lines: the first as Host and Origin, the others as messages.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  const std::string_view first = rest.substr(0, rest.find('\n'));
  if (same_origin(first, "localhost") && first.size() > 17) std::abort();
  host_is_ours(first, "typed.example");
  Session session;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size() - 1);
    if (const auto message = read_page_message(rest.substr(0, end))) session.take(*message);
    rest.remove_prefix(end + 1);
  }
  return 0;
}
