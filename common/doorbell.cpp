#include "common/doorbell.h"

#include <cstdint>
#include <sys/eventfd.h>
#include <unistd.h>

#include "common/error.h"

namespace palpate {

Doorbell::Doorbell() : descriptor_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (descriptor_ < 0) fail_at_run_time("no event descriptor left; raise the limit with `ulimit -n`");
}

Doorbell::~Doorbell() {
  close(descriptor_);
}

void Doorbell::ring() noexcept {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = write(descriptor_, &one, sizeof one);
}

void Doorbell::answer() noexcept {
  std::uint64_t rings = 0;
  [[maybe_unused]] const auto got = read(descriptor_, &rings, sizeof rings);
}

}  // namespace palpate
