#pragma once
#include <chrono>
#include <list>
#include <memory>
#include <string>

#include "tests/emulation/usb_bus.h"

namespace palpate::emulation {

/// Serves a bus: programs under test at the unix socket `path`, and scripts at `path`.ctl, a command a line,
/// each answered by one line that begins with `ok` or `error`. One thread.
class UsbServer {
 public:
  /// Listens. Throws `std::runtime_error` if it cannot.
  UsbServer(const std::string& path, UsbBus& bus);
  /// Removes both sockets.
  ~UsbServer();
  UsbServer(const UsbServer&) = delete;
  UsbServer& operator=(const UsbServer&) = delete;

  /// Serves until `signals` (a signalfd, or any other descriptor) is readable.
  void run(int signals);

 private:
  struct Script {
    int fd;
    std::string line;
  };
  double now() const;
  void wait(int signals, std::vector<int>& ready) const;
  void accept_link();
  void accept_script();
  void read_links(const std::vector<int>& ready);
  void read_scripts(const std::vector<int>& ready);
  bool read_script(Script& script);
  bool read_link(Link& link);

  std::string path_;
  UsbBus& bus_;
  int links_socket_ = -1, scripts_socket_ = -1;
  std::list<std::unique_ptr<Link>> links_;
  std::list<Script> scripts_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace palpate::emulation
