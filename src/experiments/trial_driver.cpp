#include "lodestone/experiments/trial_driver.h"

#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "lodestone/common/log.h"

namespace lodestone::experiments {
namespace {

/// One trial on the connected rig, watched, and recorded where that is asked for.
TrialResult drive_one(session::RigSession& rig, const DeploymentConfig& config, const TrialPlan& plan,
                      const ControllerSource& source, const TrialFolders& folders, const TrialWatch& watch) {
  TrialRecording recording(folders, config.record,
                           {trial_name(RigKind::kReal, source, plan),
                            plan,
                            {rig.clock(), rig.coils(), rig.camera()},
                            config.rig,
                            config.loop.period_s(),
                            source.action.scale,
                            false});
  bool told = false;
  TrialResult result = run_on_session(rig, config, plan, source, {}, [&](const TrialSample& sample) {
    if (watch) watch(sample);
    recording.show(sample);
    if (sample.step.rig_changed && !std::exchange(told, true))
      common::log_warning(
          "after " + std::to_string(std::lround(sample.step.time_s)) +
          " s the needle no longer moves as the simulator expects of any strength of the "
          "rig: look after coils, needle and camera, or learn the rig anew (lodestone adapt)");
  });
  recording.finish(result);
  return result;
}

}  // namespace

TrialDriver virtual_driver(const DeploymentConfig& config, std::int64_t threads, bool realtime,
                           const TrialFolders& folders) {
  const auto deployment = std::make_shared<const Deployment>(config);
  const auto pool = std::make_shared<common::ThreadPool>(realtime ? 1 : static_cast<std::size_t>(threads));
  TrialDriver driver;
  driver.drive = [=](const std::vector<TrialPlan>& plans, RigKind kind, const ControllerSource& source,
                     const TrialWatch&) {
    return deployment->run(plans, kind, source, *pool, realtime, folders);
  };
  driver.fits = [deployment](const geometry::Pose2& pose) { return deployment->fits(pose); };
  driver.stopped = [] { return std::string(); };
  driver.batch = 2 * pool->size();
  return driver;
}

TrialDriver session_driver(session::RigSession& rig, const DeploymentConfig& config, bool ask_to_place,
                           const TrialFolders& folders) {
  TrialDriver driver;
  driver.drive = [&rig, config, ask_to_place, folders](const std::vector<TrialPlan>& plans, RigKind,
                                                       const ControllerSource& source,
                                                       const TrialWatch& watch) {
    std::vector<TrialResult> results;
    for (const TrialPlan& plan : plans) {
      if (ask_to_place) rig.place(plan.start);
      results.push_back(drive_one(rig, config, plan, source, folders, watch));
    }
    return results;
  };
  driver.fits = [&rig](const geometry::Pose2& pose) { return rig.fits(pose); };
  driver.stopped = [&rig] { return rig.coils().latched() ? rig.coils().reason() : std::string(); };
  return driver;
}

}  // namespace lodestone::experiments
