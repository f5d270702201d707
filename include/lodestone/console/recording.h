#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lodestone/common/json.h"
#include "lodestone/console/bench_state.h"
#include "lodestone/imaging/bench.h"
#include "lodestone/imaging/frame.h"

namespace lodestone::console {

/// Records what happens on a bench into NAME.csv, a row a sample, flushed as it comes, and NAME.mp4, ten
/// annotated images a second, which is whole once the recording has ended. Works in a thread of its own; who
/// records keeps nobody waiting.
class Recording {
 public:
  struct Source {
    std::function<BenchState()> state;
    std::function<std::shared_ptr<const imaging::Frame>()> image;
    imaging::BenchGeometry bench;
    double max_current_A = 0.0;
    std::function<void(const std::string& why)> failed;  ///< told once, from the recording's thread
  };
  /// `folder` exists. Throws IoError.
  Recording(const std::string& folder, const std::string& name, Source source);
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One that is there.
struct RecordingInfo {
  std::string name;
  bool video = false;
  double seconds = 0.0;
};
/// All in a folder, newest first; damaged ones are left out.
std::vector<RecordingInfo> recordings_in(const std::string& folder);

/// A name for a new one: the time, and a number where there is one of that time.
std::string new_recording_name(const std::string& folder);

/// The samples of one, as pages have them; of a long one every so many, kMostReplayed at most. Throws IoError
/// and DataError, and DataError for a name that is none.
constexpr std::size_t kMostReplayed = 5000;
common::Json read_recording(const std::string& folder, const std::string& name);

}  // namespace lodestone::console
