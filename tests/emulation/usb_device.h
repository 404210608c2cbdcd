#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate::emulation {

using Bytes = std::vector<std::uint8_t>;
using Words = std::vector<std::string>;

/// The eight bytes that begin a control transfer.
struct UsbSetup {
  std::uint8_t type = 0, request = 0;
  std::uint16_t value = 0, index = 0, length = 0;
};

/// How a transfer ended: 0 or a negative errno (-EPIPE: stalled, -EOVERFLOW: the buffer was too small), and
/// what came in.
struct UsbResult {
  int status = 0;
  Bytes data;
};

/// A control command that cannot be carried out; the text goes back to who sent it.
struct CommandError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One emulated device, without its bus. Times are seconds of the wall clock since the emulator started.
class UsbDevice {
 public:
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  virtual ~UsbDevice() = default;

  /// The device descriptor, and its one configuration after it.
  virtual Bytes descriptors() const = 0;
  /// A string descriptor's text; empty: there is none.
  virtual std::string text(int index) const = 0;
  /// The kernel's driver that owns the interface before anybody detaches it; empty: none.
  virtual std::string kernel_driver() const { return {}; }

  /// Number of the interface that programs use; there may be others before it, which do nothing.
  virtual int interface() const { return 0; }

  virtual bool is_hub() const { return false; }

  /// A control request that is not one of the standard ones `control` answers.
  virtual UsbResult request(const UsbSetup& setup, const Bytes& data, double now) = 0;
  /// Data for an OUT endpoint; 0 or a negative errno.
  virtual int write(std::uint8_t endpoint, const Bytes& data, double now) = 0;
  /// What an IN endpoint has for a buffer of `size` bytes; none: the transfer waits.
  virtual std::optional<UsbResult> read(std::uint8_t endpoint, std::size_t size, double now) = 0;
  /// When a transfer that waits is worth another try.
  virtual double wake_at(double now) const = 0;
  /// Time passes without transfers.
  virtual void advance(double) {}
  virtual void opened(double) {}
  /// Plugged in: everything volatile is lost.
  virtual void power_up(double) = 0;

  /// A command of the control socket, its first word (the verb) and all that follow the device's name.
  /// Returns what stands after `ok`. Throws `CommandError`.
  virtual std::string command(const std::string& verb, const Words& arguments, double now);
  /// One line of JSON, an object.
  virtual std::string state(double now) = 0;

  /// All control requests: standard ones from the descriptors, the others by `request`.
  UsbResult control(const UsbSetup& setup, const Bytes& data, double now);
  bool denied() const { return denied_; }
  bool busy() const { return busy_; }

 protected:
  /// Sets the fault `name`; throws `CommandError` if there is none of that name.
  virtual void set_fault(const std::string& name, int value);

 private:
  UsbResult descriptor(const UsbSetup& setup) const;
  bool denied_ = false, busy_ = false;
};

/// A number out of a command, in [low, high]; throws `CommandError`.
double number(const std::string& word, double low, double high);

}  // namespace palpate::emulation
