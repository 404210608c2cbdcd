#pragma once
#include <filesystem>
#include <vector>

#include "protocol/capture.h"

namespace palpate::test {

/// Writes datagrams of ours into a capture, as the test says, in the order it says.
class CaptureOf {
 public:
  explicit CaptureOf(const std::filesystem::path& file) : writer_(file) {}

  void state(const protocol::ToolState& state, std::uint64_t sequence, std::uint64_t session = 7,
             std::uint16_t port = 5000) {
    add(client(port), server(), {session, sequence}, state);
  }
  void sample(const protocol::ForceSample& sample, std::uint64_t sequence, std::uint64_t session = 7,
              std::uint16_t port = 5000) {
    add(server(), client(port), {session, sequence}, sample);
  }
  void welcome(const protocol::Welcome& welcome, std::uint64_t session, std::uint16_t port = 5000) {
    add(server(), client(port), {session, 1}, welcome);
  }
  void page(const protocol::SurfacePage& page, std::uint64_t sequence) {
    add(server(), client(5000), {7, sequence}, page);
  }
  void raw(const std::vector<std::byte>& bytes) {
    writer_.write(Time{1}, client(9), server(), bytes, bytes.size());
  }
  void close() { writer_.flush(); }

  static protocol::Endpoint client(std::uint16_t port) { return {.address = {10, 0, 0, 1}, .port = port}; }
  static protocol::Endpoint server() { return {.address = {10, 0, 0, 2}, .port = 45130}; }

 private:
  void add(const protocol::Endpoint& from, const protocol::Endpoint& to, const protocol::Header& header,
           const protocol::Message& message) {
    std::array<std::byte, protocol::kMaxDatagram> bytes;
    const std::size_t size = protocol::encode(header, message, bytes);
    writer_.write(Time{++stamp_}, from, to, {bytes.data(), size}, size);
  }
  protocol::CaptureWriter writer_;
  std::int64_t stamp_ = 0;
};

}  // namespace palpate::test
