#pragma once
/// What a page makes of the binary messages: written from sim_server/viewer/MESSAGES.md alone.
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <vector>

namespace palpate::test {

struct PageDecoder {
  std::uint32_t version = 0, triangles = 0, step = 0;
  double t = 0;
  float box_min[3]{}, box_size[3]{};
  std::vector<float> rest;
  std::vector<std::uint32_t> corners;
  std::vector<std::uint8_t> flags;
  std::vector<double> positions;  // (3 n), m
  std::size_t surfaces = 0, entire_ones = 0, named = 0, cuts = 0, entire_cuts = 0;
  std::vector<double> sample_forces;
  std::vector<int> samples_missed;              // just before each
  std::vector<double> tick_times, tick_forces;  // of all ticks so far; the force felt

  void take(std::span<const std::byte> message) {
    at_ = 0;
    in_ = message;
    switch (get<std::uint8_t>()) {
      case 1:
        return topology();
      case 2:
        return surface();
      case 3:
        return ticks();
      case 4:
        return sample();
      case 6:
        return cut();
      default:
        return;
    }
  }

 private:
  template <class T>
  T get() {
    if (in_.size() - at_ < sizeof(T)) throw std::runtime_error("the message is too short");
    T value;
    std::memcpy(&value, in_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  template <class T>
  std::vector<T> all(std::size_t count) {
    std::vector<T> values(count);
    for (T& value : values) value = get<T>();
    return values;
  }
  void end() const {
    if (at_ != in_.size()) throw std::runtime_error("the message is too long");
  }
  void topology() {
    all<std::uint8_t>(3);
    version = get<std::uint32_t>();
    const auto n = get<std::uint32_t>();
    triangles = get<std::uint32_t>();
    for (float& x : box_min) x = get<float>();
    for (float& x : box_size) x = get<float>();
    rest = all<float>(3 * n);
    corners = all<std::uint32_t>(3 * triangles);
    flags = all<std::uint8_t>(n);
    end();
    positions.assign(3 * n, 0);
  }
  void cut() {
    all<std::uint8_t>(3);
    version = get<std::uint32_t>();
    triangles = get<std::uint32_t>();
    const auto k = get<std::uint32_t>(), entire = get<std::uint32_t>();
    if (entire == 1 && k != triangles) throw std::runtime_error("whole, but not all");
    std::vector<std::uint32_t> places;
    if (entire == 0) places = all<std::uint32_t>(k);
    corners.resize(3 * triangles);
    for (std::uint32_t i = 0; i < k; ++i) {
      for (std::size_t c = 0; c < 3; ++c)
        corners.at(3 * (entire == 1 ? i : places[i]) + c) = get<std::uint32_t>();
    }
    end();
    ++cuts;
    entire_cuts += entire;
  }
  void surface() {
    all<std::uint8_t>(3);
    if (get<std::uint32_t>() != version) throw std::runtime_error("a surface of another topology");
    step = get<std::uint32_t>();
    t = get<double>();
    const auto k = get<std::uint32_t>(), entire = get<std::uint32_t>();
    if (entire == 1 && 3 * k != positions.size()) throw std::runtime_error("whole, but not all");
    std::vector<std::uint32_t> numbers;
    if (entire == 0) numbers = all<std::uint32_t>(k);
    for (std::uint32_t i = 0; i < k; ++i) {
      const std::size_t v = entire == 1 ? i : numbers[i];
      for (std::size_t c = 0; c < 3; ++c)
        positions.at(3 * v + c) =
            static_cast<double>(box_min[c]) + static_cast<double>(box_size[c]) * get<std::uint16_t>() / 65535;
    }
    end();
    ++surfaces;
    entire_ones += entire;
    named += k;
  }
  void ticks() {
    get<std::uint8_t>();
    const auto laws = get<std::uint8_t>();
    get<std::uint8_t>();
    const auto count = get<std::uint32_t>();
    const auto first = get<double>();
    const auto dt = static_cast<double>(get<float>());
    for (std::uint32_t k = 0; k < count; ++k) {
      tick_times.push_back(first + dt * k);
      tick_forces.push_back(static_cast<double>(get<float>()));
    }
    all<float>(count * laws);
    end();
  }
  void sample() {
    get<std::uint8_t>();
    samples_missed.push_back(get<std::uint16_t>());
    get<double>();
    sample_forces.push_back(static_cast<double>(get<float>()));
    get<std::uint32_t>();
    end();
  }

  std::span<const std::byte> in_;
  std::size_t at_ = 0;
};

}  // namespace palpate::test
