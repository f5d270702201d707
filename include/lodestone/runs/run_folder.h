#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"

namespace lodestone::runs {

/// How far a run is: `run.json` in its folder, the one file that says so. A folder without it holds no run.
struct RunState {
  std::string verb;
  bool finished = false;
  std::string unit;  ///< what `done` and `total` count: "transitions", "epochs"
  std::int64_t done = 0;
  std::int64_t total = 0;
  std::optional<std::int64_t> checkpoint;  ///< `done` of the last checkpoint; absent: there is none
  double seconds = 0.0;                    ///< of work, without interruptions
  std::string note;                        ///< for example "loss 0.031"
  std::string updated_utc;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("verb", verb);
    v.field("finished", finished);
    v.field("unit", unit);
    v.field("done", done);
    v.field("total", total);
    v.field("checkpoint", checkpoint);
    v.field("seconds", seconds);
    v.field("note", note);
    v.field("updated_utc", updated_utc);
  }
};

/// What a verb was asked to run, and where.
struct RunRequest {
  std::string folder;
  std::string verb;
  common::Json config;  ///< resolved
  std::int64_t seed = 1;
  bool resume = false;
  /// Dotted keys that may differ between a run and its resumption, for the results do not depend on them.
  std::vector<std::string> free_keys = {"threads"};
  /// Dotted keys that say how far to go: where one of them differs, a finished run goes on.
  std::vector<std::string> length_keys = {};
  /// Files and folders that the results depend on, by what the user knows them as: a resumption must find in
  /// them what the run began with.
  std::map<std::string, std::string> inputs = {};
};

/// The files and folders that these dotted keys of a configuration name; without those that name none.
std::map<std::string, std::string> named_inputs(const common::Json& config,
                                                const std::vector<std::string>& keys);

enum class RunStage { kFresh, kResumable, kFinished };

/// Where a run was worked on, from its `manifest.json`: as it began, then, each with all it says of build,
/// host and threads, where it went on otherwise (`continued`). Empty for what is no manifest.
std::vector<common::Json> manifests_of(const common::Json& manifest);

/// The folder of one run: `config.json` (resolved), `manifest.json` (verb, seed, digests of its inputs;
/// threads, build, host, also of where it went on), `run.json` (RunState), and what the verb writes. Only one
/// process at a time works in it.
class RunFolder {
 public:
  /// Finds the run again where `resume` is set, and is fresh where there is none yet; writes nothing. Throws
  /// ConfigError when the folder is missing in the request, is not empty and `resume` is false, holds no run,
  /// one of another verb, or one with other settings or inputs (they are named); IoError; Error while another
  /// process works in it.
  explicit RunFolder(RunRequest request);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  RunStage stage() const { return stage_; }
  bool finished() const { return stage_ == RunStage::kFinished; }
  const std::string& path() const { return request_.folder; }
  std::string file(const std::string& name) const { return request_.folder + "/" + name; }
  const std::string& verb() const { return request_.verb; }
  const RunState& state() const { return state_; }
  const common::Json& config() const { return request_.config; }

  /// Makes the folder and writes what every run has; the first update() does it, too. Throws IoError.
  void begin();
  /// Writes `run.json` with what `state` says; verb, time and `finished` are filled in.
  void update(const RunState& state);
  /// What was asked for has turned out to be refused: a run that began here leaves nothing behind, one that
  /// goes on stays. Throws IoError.
  void abandon();
  /// Everything is written: from now on the run is found, and not run again.
  void finish();

 private:
  void lock();
  void find_again();
  void check_inputs() const;
  void write_manifest() const;

  RunRequest request_;
  RunState state_;
  RunStage stage_ = RunStage::kFresh;
  int lock_ = -1;
  bool begun_ = false;
  bool made_ = false;  // the folder itself
};

/// The state of the run in a folder; nothing where it holds none. Throws DataError when it is damaged.
std::optional<RunState> find_run(const std::string& folder);
/// Whether a process works in the folder right now.
bool is_running(const std::string& folder);

/// Every value of a configuration as text, by its dotted key; of a list of objects by the number of each,
/// too.
std::map<std::string, std::string> values_by_key(const common::Json& config);

/// Dotted keys in which two configurations differ, as "key = here (there: value)". Keys of `ignored` do not
/// count.
std::vector<std::string> differing_keys(const common::Json& there, const common::Json& here,
                                        const std::vector<std::string>& ignored);

}  // namespace lodestone::runs
