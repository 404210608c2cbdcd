#pragma once
#include "common/report.h"
#include "protocol/recorder.h"

namespace palpate::protocol {

/// Writes the outcome of a recording, for the report of a run that has ended.
Json recording_report(const Recorder& recorder);

/// Tells once when the disk stops taking a recording. Watching thread.
class RecordingWatcher {
 public:
  /// `recorder` may be null: then there is nothing to tell.
  explicit RecordingWatcher(const Recorder* recorder) : recorder_(recorder) {}
  void look();

 private:
  const Recorder* recorder_;
};

}  // namespace palpate::protocol
