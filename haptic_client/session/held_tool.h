#pragma once
#include <filesystem>
#include <optional>
#include <thread>

#include "common/report.h"
#include "haptic_client/session/client_config.h"
#include "haptic_client/session/server_access.h"
#include "protocol/recording_report.h"

namespace palpate::client {

/// Files that a tool leaves behind, each absent: none.
struct ToolFiles {
  std::optional<std::filesystem::path> trace;   ///< CSV of the last minute, a row a tick
  std::optional<std::filesystem::path> record;  ///< capture of every datagram
  std::optional<double> record_mb = {};         ///< size at which it goes on in a new file
  bool overwrite = false;                       ///< a capture that is there
};

/// A device with the tool it holds: the loop, the link to the server and everything between, each with a
/// thread of its own. Two of them share nothing, so that no force, delay or fault crosses from one to the
/// other. Main thread.
class HeldTool {
 public:
  /// Opens nothing yet but the socket. `name` begins what is said about it; empty where there is only one.
  /// `seconds`: how long it will run, if that is known. `device`: in the place of the configured one; null:
  /// that. Throws `Error`.
  HeldTool(const ClientConfig& config, const ToolFiles& files, std::string name,
           std::optional<double> seconds, std::unique_ptr<Device> device = nullptr);
  /// Writes zero force, says Bye to the server, ends its threads.
  ~HeldTool();

  /// Asks the server for a tool. Throws when there is none within `patience`; false on Ctrl-C.
  bool connect(Time patience = kWelcomePatience);
  /// Our own address on the way to the server.
  protocol::Endpoint local() const { return socket_.local_towards(server_); }
  /// The haptic loop runs from here on, and beats for the guardian (null: there is none).
  void start(Heartbeat* heartbeat);
  /// The haptic loop ends; zero force has left.
  void halt() { haptic_thread_ = {}; }
  /// The link and the recording end, too, which may take as long as the disk does.
  void stop();
  void rearm() { loop_.rearm = true; }

  /// Prints messages, once each: the loss and the return of the server, a latched fault, a force that is not
  /// settled or mostly not rendered, the requests of the device. Call it ten times a second.
  void look();
  /// Force, age and ticks, for a line of progress.
  std::string progress() const;

  /// After `stop`.
  Json report() const;
  /// After `stop`: the trace, if one was asked for.
  void write_files() const;

 private:
  void end_if_stuck();
  void report_weakness();
  void report_doubt();
  void report_slow_link();

  ClientConfig config_;
  ToolFiles files_;
  std::string name_;
  std::unique_ptr<Device> device_;
  Pipeline pipeline_;
  Observation observation_;
  TelemetryMaker telemetry_;
  HapticMailboxes mailboxes_;
  HapticLoop loop_;
  protocol::Endpoint server_;
  protocol::UdpSocket socket_;
  std::unique_ptr<protocol::Recorder> recorder_;  // null: nothing is recorded
  protocol::RecordingWatcher recording_;
  NetLink link_;
  const char* device_status_ = "";
  std::uint64_t ticks_ = 0;  // when looked at last
  int standstills_ = 0;      // looks since then
  bool real_time_ = false;
  /// States that the log has told.
  struct Told {
    bool silent = false, weak = false, paused = false, slow = false, drops_large = false;
  } told_;
  Fault fault_ = Fault::kNone;
  std::optional<Doubt> doubt_;
  std::jthread recording_thread_, net_thread_, haptic_thread_;
};

}  // namespace palpate::client
