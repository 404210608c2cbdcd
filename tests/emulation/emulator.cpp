#include "tests/emulation/emulator.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include "tests/emulation/wire.h"
#include "tests/support/paths.h"

namespace palpate::test {
namespace {

std::string new_folder() {
  char path[] = "/tmp/palpate_usb_XXXXXX";  // short: a socket's path has at most 107 characters
  if (mkdtemp(path) == nullptr) throw std::runtime_error("no folder in /tmp");
  return path;
}

std::vector<std::string> arguments(const std::string& socket, const std::vector<std::string>& devices,
                                   const std::vector<std::string>& more) {
  std::vector<std::string> all{"--socket", socket, "--die-with-parent"};
  for (const std::string& device : devices) all.insert(all.end(), {"--device", device});
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace

Emulator::Emulator(const std::vector<std::string>& devices, const std::vector<std::string>& more)
    : folder_(new_folder()), socket_(folder_ + "/usb") {
  process_ = std::make_unique<Process>("falcon_emulator", arguments(socket_, devices, more));
  if (process_->wait_for("serving")) return;
  const std::string said = process_->output();
  process_.reset();
  std::filesystem::remove_all(folder_);
  throw std::runtime_error("no emulator: " + said);
}

Emulator::~Emulator() {
  try {
    process_->signal(SIGTERM);
    process_->wait(5);
  } catch (const std::runtime_error&) {  // the next line kills it
  }
  process_.reset();
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void Emulator::nap() {
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

int Emulator::connect_to_control() const {
  const int fd = emulation::wire::connect_to(socket_ + ".ctl");
  if (fd < 0) throw std::runtime_error("nobody answers at " + socket_ + ".ctl");
  const timeval patience{10, 0};
  setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  return fd;
}

std::string Emulator::command(const std::string& line) const {
  const int fd = connect_to_control();
  const std::string ask = line + "\n";
  std::string answer;
  char buffer[4096];
  ssize_t got = ::send(fd, ask.data(), ask.size(), MSG_NOSIGNAL);
  while (got > 0 && answer.find('\n') == std::string::npos) {
    got = recv(fd, buffer, sizeof buffer, 0);
    if (got > 0) answer.append(buffer, static_cast<std::size_t>(got));
  }
  close(fd);
  answer = answer.substr(0, answer.find('\n'));
  if (answer.rfind("ok", 0) != 0) throw std::runtime_error(line + ": " + answer);
  return answer.size() > 3 ? answer.substr(3) : "";
}

nlohmann::json Emulator::state(const std::string& device) const {
  return nlohmann::json::parse(command("state " + device));
}

std::vector<std::pair<std::string, std::string>> Emulator::environment() const {
  const std::string shim = bin_dir() + "/libusb_vhci_shim.so";
  if (shim.find_first_of(" :") != std::string::npos)  // it would not be loaded, and real devices be taken
    throw std::runtime_error(shim + ": a library to preload has neither space nor colon in its path");
  const char* options = std::getenv("ASAN_OPTIONS");
  const std::string before = options == nullptr || *options == 0 ? "" : std::string(options) + ":";
  return {{"LD_PRELOAD", shim},
          {"USBSHIM", socket_},
          {"ASAN_OPTIONS", before + "verify_asan_link_order=0"}};  // the shim stands before the sanitizer
}

std::unique_ptr<Process> Emulator::start(const std::string& program,
                                         const std::vector<std::string>& arguments) const {
  const Environment environment(this->environment());
  return std::make_unique<Process>(program, arguments);
}

Environment::Environment(const std::vector<std::pair<std::string, std::string>>& variables) {
  for (const auto& [name, value] : variables) {
    const char* old = std::getenv(name.c_str());
    old_.push_back({name, old == nullptr ? "" : old, old != nullptr});
    setenv(name.c_str(), value.c_str(), 1);
  }
}

Environment::~Environment() {
  for (const Old& old : old_) {
    if (old.was_set) {
      setenv(old.name.c_str(), old.value.c_str(), 1);
    } else {
      unsetenv(old.name.c_str());
    }
  }
}

}  // namespace palpate::test
