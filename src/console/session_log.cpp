#include "lodestone/console/session_log.h"

#include <utility>

#include "lodestone/common/build_facts.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/log.h"

namespace lodestone::console {
namespace {

const char* name_of(BenchEvent::Level level) {
  return level == BenchEvent::Level::kInfo      ? "info"
         : level == BenchEvent::Level::kWarning ? "warning"
                                                : "stop";
}

}  // namespace

SessionLog::SessionLog(const std::string& folder) : file_(folder + "/events.jsonl") {
  common::make_folders(folder);
  out_.open(file_, std::ios::app);
  if (!out_)
    throw common::IoError(file_ + " cannot be written: check that the disk has room and the folder is yours");
}

common::Json SessionLog::add(const BenchEvent& event) {
  const std::lock_guard<std::mutex> writing(writing_);
  common::Json json = {{"kind", "event"},
                       {"time_s", event.time_s},
                       {"utc", common::utc_now()},
                       {"level", name_of(event.level)},
                       {"text", event.text}};
  out_ << json.dump(-1, ' ', false, common::Json::error_handler_t::replace) << std::endl;
  if (!out_ && !std::exchange(told_, true))
    common::log_warning(file_ + " can no longer be written: what happens from now on is not on record");
  const std::lock_guard<std::mutex> lock(mutex_);
  events_.push_back(json);
  if (events_.size() > kKept) events_.pop_front();
  return json;
}

common::Json SessionLog::last() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return common::Json(events_);
}

}  // namespace lodestone::console
