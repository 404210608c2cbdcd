#include "protocol/recording_report.h"

#include <nlohmann/json.hpp>

#include "common/log.h"

namespace palpate::protocol {

Json recording_report(const Recorder& recorder) {
  const Recorder::Stats stats = recorder.stats();
  return {{"file", recorder.file().string()}, {"files", stats.files},
          {"packets", stats.packets},         {"bytes", stats.bytes},
          {"dropped", stats.dropped},         {"refused", stats.refused},
          {"failed", recorder.failed.load()}};
}

void RecordingWatcher::look() {
  if (recorder_ == nullptr || !recorder_->failed) return;
  log::warning("{}: could not be written on; is the disk full? The recording stopped, the session goes on",
               recorder_->file().string());
  recorder_ = nullptr;
}

}  // namespace palpate::protocol
