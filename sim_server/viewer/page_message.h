#pragma once
/// Messages from a page, parsed without trust. No clock, no socket.
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "sim_server/viewer/picture.h"

namespace palpate::sim {

struct PageHello {
  std::string token;
};
struct PageWant {
  std::string field;  ///< empty: none
};
/// Message that the page drew the surface of this step. Pages that send it never have more than a few
/// surfaces on their way.
struct PageShown {
  std::uint32_t step = 0;
};
struct PagePause {
  bool paused = false;
};
struct PageStep {};
struct PageChoose {
  std::string scene;
};
using PageMessage =
    std::variant<PageHello, PageWant, PageShown, PagePause, PageStep, PagePointer, PageChoose>;

/// The longest that is read; a longer one closes the connection.
constexpr std::size_t kLongestPageMessage = 4096;

/// Nothing where it is no message of a page: no JSON object with one key that is known, or a value of another
/// kind or out of range (a pointer is within 1 km of the origin, its tool below `kMaxTools`).
std::optional<PageMessage> read_page_message(std::string_view text);

}  // namespace palpate::sim
