#pragma once

namespace palpate {

/// Wakes a thread that waits in an event loop (an eventfd): a loop rings after it wrote to a mailbox, the
/// network thread waits for `descriptor()` to become readable. Ringing never blocks; rings that nobody
/// answered merge.
class Doorbell {
 public:
  /// Throws `Error` when the system has no descriptor left.
  Doorbell();
  ~Doorbell();
  Doorbell(const Doorbell&) = delete;
  Doorbell& operator=(const Doorbell&) = delete;

  /// Any thread; about 0.3 us, no lock of ours, no allocation.
  void ring() noexcept;

  /// Takes all rings so far; the waiting thread only.
  void answer() noexcept;

  /// Readable while a ring waits. Owned by the doorbell.
  int descriptor() const noexcept { return descriptor_; }

 private:
  int descriptor_;
};

}  // namespace palpate
