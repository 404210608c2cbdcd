#pragma once
/// A browser's end of the live page, as far as a test needs it: RFC 9112 and RFC 6455 on a plain socket.
#include <arpa/inet.h>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/support/page_decoder.h"
#include "tests/support/process.h"

namespace palpate::test {

/// Where a server says that its page is.
struct PageAddress {
  std::uint16_t port = 0;
  std::string token;
  std::string host() const { return "127.0.0.1:" + std::to_string(port); }

  /// "the live page: http://127.0.0.1:PORT/#token=TOKEN" in what the program says, when it has said `after`.
  static PageAddress of(Process& process, const std::string& after = "listening on ") {
    if (!process.wait_for(after)) throw std::runtime_error("no server: " + process.output());
    const std::string& said = process.output();
    const std::string kBefore = "http://127.0.0.1:", kToken = "#token=";
    const std::size_t at = said.rfind(kBefore);
    if (at == std::string::npos) throw std::runtime_error("no page: " + said);
    const std::string line = said.substr(at, said.find('\n', at) - at);
    const std::size_t token = line.find(kToken);
    return {static_cast<std::uint16_t>(std::stoi(line.substr(kBefore.size()))),
            token == std::string::npos ? "" : line.substr(token + kToken.size())};
  }
};

/// A TCP connection.
class TcpEnd {
 public:
  explicit TcpEnd(std::uint16_t port, int receive_buffer = 0) : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0) setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(fd_, reinterpret_cast<sockaddr*>(&to), sizeof to) != 0)
      throw std::runtime_error("nobody listens on port " + std::to_string(port));
  }
  ~TcpEnd() { close(fd_); }
  TcpEnd(const TcpEnd&) = delete;
  TcpEnd& operator=(const TcpEnd&) = delete;

  void write(const std::string& bytes) const {
    [[maybe_unused]] const auto sent = send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  /// What comes next, at most `most` bytes; empty when nothing came for `seconds`, or the other end closed.
  std::string read(std::size_t most, double seconds) {
    pollfd waiting{fd_, POLLIN, 0};
    if (poll(&waiting, 1, static_cast<int>(1e3 * seconds)) <= 0) return {};
    std::string bytes(most, '\0');
    const auto got = recv(fd_, bytes.data(), most, 0);
    closed_ = got <= 0;
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }
  bool closed() const { return closed_; }

 private:
  int fd_;
  bool closed_ = false;
};

/// All that a server answers to these bytes, until it closes or says nothing for half a second.
inline std::string answer_to(std::uint16_t port, const std::string& request) {
  TcpEnd end(port);
  end.write(request);
  std::string all;
  for (;;) {
    const std::string more = end.read(65536, 0.5);
    if (more.empty()) return all;
    all += more;
  }
}

/// One WebSocket.
class WebPage {
 public:
  struct Manners {
    std::string path = "/live", protocol = "palpate-view-1";
    std::optional<std::string> host{}, origin{};
    int receive_buffer = 0;
  };
  explicit WebPage(const PageAddress& address) : WebPage(address, Manners()) {}
  WebPage(const PageAddress& address, const Manners& manners) : tcp_(address.port, manners.receive_buffer) {
    const std::string host = manners.host.value_or(address.host());
    const std::string origin = manners.origin.value_or("http://" + host);
    tcp_.write("GET " + manners.path + " HTTP/1.1\r\nHost: " + host +
               "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
               "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
               (origin.empty() ? "" : "Origin: " + origin + "\r\n") +
               (manners.protocol.empty() ? "" : "Sec-WebSocket-Protocol: " + manners.protocol + "\r\n") +
               "\r\n");
    while (in_.find("\r\n\r\n") == std::string::npos) {
      const std::string more = tcp_.read(4096, 2);
      if (more.empty()) return;
      in_ += more;
    }
    // RFC 6455, section 1.3: the answer to its own example of a key.
    open_ = in_.starts_with("HTTP/1.1 101") && in_.find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") != std::string::npos;
    in_ = in_.substr(in_.find("\r\n\r\n") + 4);
  }

  bool open() const { return open_; }

  /// One frame, masked unless a server should be shocked.
  void send_frame(int first_byte, const std::string& payload, bool masked = true) {
    std::string frame(1, static_cast<char>(first_byte));
    const int bit = masked ? 0x80 : 0;
    if (payload.size() < 126) {
      frame += static_cast<char>(bit | static_cast<int>(payload.size()));
    } else {
      frame += static_cast<char>(bit | 126);
      frame += static_cast<char>(payload.size() >> 8);
      frame += static_cast<char>(payload.size() & 0xff);
    }
    const std::string mask = "\x12\x34\x56\x78";
    if (masked) frame += mask;
    for (std::size_t i = 0; i < payload.size(); ++i)
      frame += masked ? static_cast<char>(payload[i] ^ mask[i % 4]) : payload[i];
    tcp_.write(frame);
  }
  void say(const std::string& json) { send_frame(0x81, json); }
  void hello(const std::string& token = {}) { say(R"({"hello": {"token": ")" + token + "\"}}"); }

  struct Frame {
    int kind = 0;  ///< 1 text, 2 binary, 8 close, 9 ping
    std::string payload;
  };
  /// The next frame; nothing when none came for `seconds`, or the server closed.
  std::optional<Frame> next(double seconds = 3) {
    while (in_.size() < 2 || in_.size() < frame_size()) {
      const std::string more = tcp_.read(65536, seconds);
      if (more.empty()) return {};
      in_ += more;
    }
    const std::size_t size = frame_size();
    Frame frame{in_[0] & 15, in_.substr(header_size(), size - header_size())};
    in_.erase(0, size);
    if (frame.kind == 9) send_frame(0x8a, frame.payload);
    if (frame.kind == 2) decoder.take(std::as_bytes(std::span(frame.payload)));
    return frame;
  }
  /// The next text message of this name, after what else comes; null when none came for `seconds`.
  nlohmann::json next_text(const std::string& name, double seconds = 3) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
      const auto frame = next(seconds);
      if (!frame) return nullptr;
      if (frame->kind != 1) continue;
      const auto json = nlohmann::json::parse(frame->payload);
      if (json.contains(name)) return json[name];
    }
    return nullptr;
  }
  /// The code with which the server closes, after what else comes; 0: it closed without, -1: not within
  /// `seconds`.
  int close_code(double seconds = 3) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
      const auto frame = next(0.2);
      if (!frame && tcp_.closed()) return 0;
      if (frame && frame->kind == 8 && frame->payload.size() >= 2)
        return (static_cast<unsigned char>(frame->payload[0]) << 8) +
               static_cast<unsigned char>(frame->payload[1]);
    }
    return -1;
  }

  PageDecoder decoder;

 private:
  std::size_t header_size() const {
    const int size = in_[1] & 127;
    return size < 126 ? 2 : size == 126 ? 4 : 10;
  }
  std::size_t frame_size() const {
    const int small = in_[1] & 127;
    if (small < 126) return 2 + static_cast<std::size_t>(small);
    if (in_.size() < header_size()) return header_size();
    std::size_t size = 0;
    for (std::size_t i = 2; i < header_size(); ++i) size = (size << 8) | static_cast<unsigned char>(in_[i]);
    return header_size() + size;
  }

  TcpEnd tcp_;
  std::string in_;
  bool open_ = false;
};

}  // namespace palpate::test
