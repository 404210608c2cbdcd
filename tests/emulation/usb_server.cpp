#include "tests/emulation/usb_server.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <poll.h>
#include <stdexcept>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace palpate::emulation {
namespace {

constexpr double kTick = 0.02;  // s: at least so often time passes for the devices

int listen_on(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path)
    throw std::runtime_error(path + ": a socket's path has at most 107 characters");
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 || listen(fd, 16) != 0) {
    const std::string why = std::strerror(errno);
    close(fd);
    throw std::runtime_error(path + ": " + why);
  }
  return fd;
}

bool contains(const std::vector<int>& all, int one) {
  return std::ranges::find(all, one) != all.end();
}

}  // namespace

UsbServer::UsbServer(const std::string& path, UsbBus& bus) : path_(path), bus_(bus) {
  links_socket_ = listen_on(path);
  try {
    scripts_socket_ = listen_on(path + ".ctl");
  } catch (...) {
    close(links_socket_);
    unlink(path.c_str());
    throw;
  }
}

UsbServer::~UsbServer() {
  bus_.links.clear();
  for (const Script& script : scripts_) close(script.fd);
  close(links_socket_);
  close(scripts_socket_);
  unlink(path_.c_str());
  unlink((path_ + ".ctl").c_str());
}

double UsbServer::now() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void UsbServer::wait(int signals, std::vector<int>& ready) const {
  std::vector<pollfd> all{{signals, POLLIN, 0}, {links_socket_, POLLIN, 0}, {scripts_socket_, POLLIN, 0}};
  for (const auto& link : links_) all.push_back({link->fd, POLLIN, 0});
  for (const Script& script : scripts_) all.push_back({script.fd, POLLIN, 0});
  const double before = now();
  const double seconds = std::clamp(bus_.wake_at(before) - before, 0.0, kTick);
  const timespec timeout{0, static_cast<long>(std::ceil(seconds * 1e9))};
  ready.clear();
  if (ppoll(all.data(), all.size(), &timeout, nullptr) <= 0) return;
  for (const pollfd& one : all) {
    if (one.revents != 0) ready.push_back(one.fd);
  }
}

void UsbServer::run(int signals) {
  std::vector<int> ready;
  while (!contains(ready, signals)) {
    wait(signals, ready);
    read_links(ready);
    read_scripts(ready);
    if (contains(ready, links_socket_)) accept_link();
    if (contains(ready, scripts_socket_)) accept_script();
    bus_.serve(now());
  }
}

void UsbServer::accept_link() {
  const int fd = accept4(links_socket_, nullptr, nullptr, SOCK_CLOEXEC);
  if (fd < 0) return;
  links_.push_back(std::make_unique<Link>(fd));
  bus_.links.push_back(links_.back().get());
}

void UsbServer::accept_script() {
  const int fd = accept4(scripts_socket_, nullptr, nullptr, SOCK_CLOEXEC);
  if (fd >= 0) scripts_.push_back({fd, {}});
}

bool UsbServer::read_link(Link& link) {
  if (!link.reader.fill(link.fd, false)) return false;
  while (const auto frame = link.reader.next()) {
    if (!bus_.handle(link, *frame, now())) return false;
  }
  return !link.reader.broken();
}

void UsbServer::read_links(const std::vector<int>& ready) {
  for (auto link = links_.begin(); link != links_.end();) {
    if (!contains(ready, (*link)->fd) || read_link(**link)) {
      ++link;
      continue;
    }
    bus_.closed(**link);
    std::erase(bus_.links, link->get());
    link = links_.erase(link);
  }
}

bool UsbServer::read_script(Script& script) {
  char buffer[4096];
  const ssize_t got = recv(script.fd, buffer, sizeof buffer, MSG_DONTWAIT);
  if (got <= 0) return got < 0 && errno == EAGAIN;
  script.line.append(buffer, static_cast<std::size_t>(got));
  for (std::size_t end = 0; (end = script.line.find('\n')) != std::string::npos;) {
    const std::string answer = bus_.command(script.line.substr(0, end), now()) + "\n";
    script.line.erase(0, end + 1);
    if (::send(script.fd, answer.data(), answer.size(), MSG_NOSIGNAL) < 0) return false;
  }
  return script.line.size() < sizeof buffer;
}

void UsbServer::read_scripts(const std::vector<int>& ready) {
  for (auto script = scripts_.begin(); script != scripts_.end();) {
    if (!contains(ready, script->fd) || read_script(*script)) {
      ++script;
      continue;
    }
    close(script->fd);
    script = scripts_.erase(script);
  }
}

}  // namespace palpate::emulation
