// The studies that the programs themselves cannot do: they judge places, flags and hands at each step. Run by
// `scripts/study`; the same arguments give the same bytes.
#include <algorithm>
#include <atomic>
#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/studies/studies.h"

namespace palpate::studies {

Option quick_option(bool& quick) {
  return {"--quick", "Fewer cases, shorter motions", &quick};
}

void for_all(std::size_t count, const char* what,
             const std::function<std::function<void(std::size_t)>()>& worker) {
  std::atomic<std::size_t> next{0}, done{0};
  std::vector<std::jthread> workers;
  for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i) {
    workers.emplace_back([&] {
      const auto work = worker();
      for (std::size_t k; (k = next++) < count;) {
        work(k);
        fmt::print(stderr, "{}: {} of {}\n", what, ++done, count);
      }
    });
  }
}

void ForceErrors::add(const Vec3& rendered, const Vec3& right) {
  errors_.push_back((rendered - right).norm());
  error_squares_ += (rendered - right).squaredNorm();
  squares_ += right.squaredNorm();
}

Json ForceErrors::percent() {
  if (errors_.empty() || !(squares_ > 0)) return nullptr;
  std::ranges::sort(errors_);
  double sum = 0;
  for (const double e : errors_) sum += e;
  const double count = static_cast<double>(errors_.size()), rms = std::sqrt(squares_ / count);
  const auto at = [&](double fraction) { return errors_[static_cast<std::size_t>(fraction * (count - 1))]; };
  return {
      {"mean", 100 * sum / count / rms}, {"p99", 100 * at(0.99) / rms}, {"max", 100 * errors_.back() / rms}};
}

namespace {

Command studies() {
  return {.name = "studies",
          .summary = "Studies of tools and hands at their extremes, in virtual time.",
          .footer = "Example: studies robustness teleported \"implicit neo_hookean\"",
          .commands = {robustness_command(), stability_command(), link_command()}};
}

}  // namespace
}  // namespace palpate::studies

int main(int argc, char** argv) {
  return palpate::run_program("studies", argc, argv, &palpate::studies::studies);
}
