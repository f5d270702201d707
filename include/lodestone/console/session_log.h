#pragma once

#include <deque>
#include <fstream>
#include <mutex>
#include <string>

#include "lodestone/common/json.h"
#include "lodestone/console/bench.h"

namespace lodestone::console {

/// What happened while the console was open: `events.jsonl` in its folder, a line an event, there before
/// anybody is told; and the last of them for pages that come later. From any thread; only add() waits for the
/// disk.
class SessionLog {
 public:
  static constexpr std::size_t kKept = 300;

  /// Makes the folder, and goes on with a file that is there. Throws IoError.
  explicit SessionLog(const std::string& folder);
  /// The event as pages have it: {"kind": "event", "time_s", "utc", "level", "text"}. A disk that is full is
  /// told on the terminal, once, and stops nothing.
  common::Json add(const BenchEvent& event);
  common::Json last() const;

 private:
  std::string file_;
  std::mutex writing_;  // of the file
  std::ofstream out_;
  bool told_ = false;
  mutable std::mutex mutex_;  // of what follows
  std::deque<common::Json> events_;
};

}  // namespace lodestone::console
