#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/common/json.h"
#include "lodestone/console/bench.h"
#include "lodestone/session/rig_check.h"

namespace lodestone::console {

/// Something that is started from the page and takes its time: another run of this program, or a walk that
/// asks questions.
struct JobKind {
  std::string verb;                  ///< "collect", as people know it
  std::vector<std::string> command;  ///< of the other program; {out} stands for the folder of the new run
  std::function<void(session::Dialogue& dialogue)> walk;  ///< instead of a command
  bool needs_the_rig = true;                              ///< the bench lets go of it meanwhile
  std::string stop_file = {};  ///< what drives the rig stops as soon as this file is there; empty: none
  bool attended = true;        ///< somebody stands at the rig, who can press its switch
};

/// One job at a time, in a thread of its own. While it has the rig the bench does not, and a stop is passed
/// on.
class Jobs {
 public:
  /// `bench` must outlive it. Runs lie in `runs`, named after verb and time.
  Jobs(Bench& bench, std::vector<JobKind> kinds, std::string runs,
       std::function<void(const std::string&)> tell);
  /// Ends the job that runs.
  ~Jobs();
  Jobs(const Jobs&) = delete;
  Jobs& operator=(const Jobs&) = delete;

  std::vector<std::string> verbs() const;
  // From any thread; why not, empty: it is done.
  std::string start(const std::string& verb);
  std::string end();
  std::string answer(bool yes);

  /// {"verb", "running", "done", "total", "note", "text"} of the job that runs or was last; null: there was
  /// none.
  common::Json now() const;
  /// What the operator is asked; null: nothing.
  common::Json question() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodestone::console
