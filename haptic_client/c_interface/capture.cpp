#include "protocol/capture.h"

#include <algorithm>

#include "protocol/c_interface/border.h"
#include "protocol/c_interface/c_messages.h"
#include "protocol/earlier_ticks.h"

using namespace palpate;

/// A capture with what was learnt of it so far.
struct palpate_capture {
  explicit palpate_capture(const char* name) : file(name), reader(name) {}

  std::string file;
  protocol::CaptureReader reader;
  protocol::Endpoint server;  ///< of the newest message that shows who that is
  bool knows_server = false, reported_trouble = false;
  std::vector<protocol::ToolState> ticks;  ///< of the newest datagram that are still to come, newest first
  palpate_datagram around{};               ///< that datagram

  std::uint32_t direction(const protocol::CapturedDatagram& packet, const protocol::Message& message);
};

/// Returns the direction by the message, where that goes one way only; a Bye is the server's if that was seen
/// before it.
std::uint32_t palpate_capture::direction(const protocol::CapturedDatagram& packet,
                                         const protocol::Message& message) {
  if (std::holds_alternative<protocol::Bye>(message)) {
    if (!knows_server || (packet.to != server && packet.from != server)) return PALPATE_UNKNOWN;
    return packet.to == server ? PALPATE_TO_SERVER : PALPATE_TO_CLIENT;
  }
  const bool to_server = std::holds_alternative<protocol::Hello>(message) ||
                         std::holds_alternative<protocol::ToolState>(message) ||
                         std::holds_alternative<protocol::Telemetry>(message);
  server = to_server ? packet.to : packet.from;
  knows_server = true;
  return to_server ? PALPATE_TO_SERVER : PALPATE_TO_CLIENT;
}

namespace {

/// Behind the last datagram; the first time, why it is the last, if that is a fault of the file.
void end(palpate_capture& capture, palpate_datagram& published) {
  published.type = PALPATE_END;
  if (const std::string trouble = capture.reader.trouble(); !trouble.empty() && !capture.reported_trouble) {
    capture.reported_trouble = true;
    fail_at_run_time("{}: {}", capture.file, trouble);
  }
}

/// One of the ticks that travelled in one datagram.
void next_tick(palpate_capture& capture, palpate_datagram& published, palpate_tool_state* tool) {
  const std::uint32_t size = published.struct_size;
  published = capture.around;
  published.struct_size = size;
  if (tool != nullptr) c_interface::write_tool_state(capture.ticks.back(), *tool);
  capture.ticks.pop_back();
}

void next(palpate_capture& capture, palpate_datagram& published, palpate_tool_state* tool,
          palpate_force_sample* sample) {
  const std::uint32_t size = published.struct_size;
  if (!capture.ticks.empty()) return next_tick(capture, published, tool);
  published = {};
  published.struct_size = size;
  protocol::CapturedDatagram packet;
  if (!capture.reader.next(packet)) return end(capture, published);
  published.bytes = static_cast<std::uint32_t>(packet.length);
  published.time_ns = packet.t.count();
  protocol::Datagram datagram;
  if (protocol::decode(packet.bytes, datagram) != protocol::Verdict::kAccepted) {
    published.type = PALPATE_NOT_OURS;
    return;
  }
  published.type =
      std::visit([](const auto& m) { return static_cast<std::uint32_t>(std::decay_t<decltype(m)>::kType); },
                 datagram.message);
  published.direction = capture.direction(packet, datagram.message);
  published.session = datagram.header.session;
  published.sequence = datagram.header.sequence;
  capture.ticks = protocol::ticks_of(datagram);
  std::ranges::reverse(capture.ticks);
  capture.around = published;
  if (!capture.ticks.empty()) next_tick(capture, published, tool);
  if (const auto* force = std::get_if<protocol::ForceSample>(&datagram.message);
      force != nullptr && sample != nullptr)
    c_interface::write_force_sample(*force, *sample);
}

}  // namespace

int palpate_capture_open(const char* file, palpate_capture** capture, char* error, std::size_t error_size) {
  if (capture != nullptr) *capture = nullptr;
  return c_interface::guarded(error, error_size, [&] {
    if (file == nullptr || capture == nullptr) fail("palpate_capture_open: file or capture is NULL");
    *capture = new palpate_capture(file);
  });
}

int palpate_capture_next(palpate_capture* capture, palpate_datagram* datagram, palpate_tool_state* tool,
                         palpate_force_sample* sample, char* error, std::size_t error_size) {
  return c_interface::guarded(error, error_size, [&] {
    c_interface::require_handle(capture, "capture");
    c_interface::require_complete(datagram, "datagram");
    if (tool != nullptr) c_interface::require_complete(tool, "tool");
    if (sample != nullptr) c_interface::require_complete(sample, "sample");
    next(*capture, *datagram, tool, sample);
  });
}

void palpate_capture_close(palpate_capture* capture) {
  delete capture;
}
