#include "tests/emulation/falcon_mcu.h"

#include <cmath>

namespace palpate::emulation {
namespace {

constexpr double kGreetingBaud = 9600, kLoadingBaud = 142857, kRunningBaud = 1.5e6;
constexpr std::uint8_t kStartOfImage = 0x41, kXoff = 0x13;
constexpr std::size_t kSmallestImage = 4096, kFailsAfter = 1000, kCorrupted = 2000;  // bytes
const Bytes kGreeting{0x0a, 0x43, 0x0d}, kGreetingAnswer{0x0a, 0x44, 0x2c, 0x0d};

bool is(double baud, double wanted) {
  return std::abs(baud - wanted) < 0.04 * wanted;  // what a UART forgives
}

bool count_down(int& counter) {
  if (counter <= 0) return false;
  --counter;
  return true;
}

}  // namespace

void FalconMcu::power_up() {
  mode_ = Mode::kWaiting;
  greeting_.clear();
  image_.clear();
  parser_.clear();
  spoiled_ = false;
}

void FalconMcu::set_dtr(bool high) {
  if (high && !dtr_) {
    power_up();
    ++resets_;
  }
  dtr_ = high;
}

void FalconMcu::set_baud(double baud) {
  const bool complete = mode_ == Mode::kLoading && image_.size() >= kSmallestImage && !spoiled_;
  if (complete && is(baud, kRunningBaud)) mode_ = Mode::kRunning;
}

std::vector<Bytes> FalconMcu::receive(const Bytes& bytes, double baud) {
  std::vector<Bytes> answers;
  if (faults_.mute != 0) return answers;
  if (mode_ == Mode::kRunning) {
    if (is(baud, kRunningBaud)) run(bytes, answers);
  } else if (is(baud, kGreetingBaud)) {
    for (const std::uint8_t byte : bytes) greet(byte, answers);
  } else if (is(baud, kLoadingBaud) && mode_ != Mode::kWaiting) {
    load(bytes, answers);
  }
  return answers;
}

void FalconMcu::greet(std::uint8_t byte, std::vector<Bytes>& answers) {
  greeting_.push_back(byte);
  if (greeting_.size() > kGreeting.size()) greeting_.erase(greeting_.begin());
  if (greeting_ != kGreeting) return;
  greeting_.clear();
  if (count_down(faults_.loader_silent)) return;
  Bytes answer = kGreetingAnswer;
  if (faults_.loader_zero != 0) answer.insert(answer.begin(), 0);
  answers.push_back(answer);
  mode_ = Mode::kGreeted;
}

void FalconMcu::load(const Bytes& bytes, std::vector<Bytes>& answers) {
  Bytes echo;
  for (const std::uint8_t byte : bytes) {
    if (mode_ == Mode::kGreeted) {
      if (byte != kStartOfImage) continue;
      mode_ = Mode::kLoading;
      failing_ = count_down(faults_.loader_fails);
      corrupting_ = !failing_ && count_down(faults_.echo_corrupt);
      if (faults_.loader_xoff != 0) echo.push_back(kXoff);
      echo.push_back(byte);
      continue;
    }
    image_.push_back(byte);
    const bool corrupted = corrupting_ && image_.size() == kCorrupted;
    if (failing_ && image_.size() > kFailsAfter) spoiled_ = true;
    if (corrupted) spoiled_ = true;
    if (!spoiled_ || corrupting_) echo.push_back(static_cast<std::uint8_t>(byte ^ (corrupted ? 0x10 : 0)));
  }
  if (!echo.empty()) answers.push_back(echo);
}

void FalconMcu::run(const Bytes& bytes, std::vector<Bytes>& answers) {
  for (const std::uint8_t byte : bytes) {
    parser_.feed(byte);
    while (const auto packet = parser_.next()) answers.push_back(encode(exchange_(*packet)));
  }
}

}  // namespace palpate::emulation
