#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/console/bench_state.h"
#include "lodestone/console/goal.h"
#include "lodestone/control/reference.h"
#include "lodestone/experiments/deployment.h"
#include "lodestone/geometry/path.h"
#include "lodestone/imaging/frame.h"
#include "lodestone/session/rig_session.h"
#include "lodestone/task/route_map.h"

namespace lodestone::console {

/// Something worth telling: what happened on the bench, and when on its clock.
struct BenchEvent {
  enum class Level { kInfo, kWarning, kStop };
  Level level = Level::kInfo;
  double time_s = 0.0;
  std::string text;
};

/// Drives one rig for an operator, in a thread of its own: connects, looks, arms, runs, and stops. Everything
/// may be called from any thread and returns at once, whatever the rig does. A second thread is the dead
/// man's switch.
class Bench {
 public:
  struct Parts {
    /// Throws common::Error where a part of the rig is missing; is asked again every two seconds then.
    std::function<std::unique_ptr<session::RigSession>()> connect;
    experiments::DeploymentConfig config;
    std::vector<experiments::ControllerSource> sources;  ///< at least one; the first drives at first
    std::function<void(const BenchEvent& event)> tell;   ///< from any thread
    std::shared_ptr<const task::RouteMap> routes;  ///< by which points are gone to; null: straight to them
  };
  explicit Bench(Parts parts);
  ~Bench();  ///< as end()
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  /// Ends a run, coils off, and lets go of the rig: nothing is done any more, and the state stays as it is.
  void end();

  /// Is told why something could not be done; empty: it is.
  using Done = std::function<void(const std::string& why_not)>;
  void arm(Done done);
  void disarm(Done done);
  /// `reason`: the one that the operator has seen; `clears`: and that faults of the coil controller are
  /// cleared with it.
  void rearm(const std::string& reason, bool clears, Done done);
  /// Has the needle placed at the centre, where the rig can; else its place is forgotten.
  void place(Done done);
  /// Lets go of the rig, for another program, until take_up().
  void let_go(const std::string& reason, Done done);
  void take_up();

  // These return why not; empty: it is done.
  std::string choose(const std::string& controller);
  std::string set_unattended(bool on);
  /// Begins a run, or gives the one that is under way another goal.
  std::string drive(const Goal& goal);
  /// Shown, not followed.
  void show_plan(const std::optional<geometry::Path>& path);
  /// The drive that the operator's hand holds, in [-1, 1]^2; begins a run where none is, and (0, 0) ends it.
  std::string hold(const geometry::Vector2& drive);
  std::string end_run();

  /// Switches off now and for good, until rearm(). The first reason counts.
  void stop(const std::string& reason);
  /// The heartbeat of the operator's page.
  void beat(bool visible, bool focused);
  /// Another page operates from now on, or nobody.
  void handed_over(bool to_somebody);

  BenchState state() const;
  /// Those of the last ten minutes.
  std::vector<BenchSample> samples() const;
  /// The newest image; null where there is none.
  std::shared_ptr<const imaging::Frame> image() const;
  /// Somebody looks on: between runs the needle is only looked for when somebody does.
  void watched();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodestone::console
