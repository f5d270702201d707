#include "lodestone/experiments/collection.h"

#include <algorithm>

#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"

namespace lodestone::experiments {

namespace {

/// No target, only an end: after some steps, or when something says so.
class UntilOver final : public control::Reference {
 public:
  UntilOver(std::function<bool()> over, double duration_s)
      : over_(std::move(over)), duration_s_(duration_s) {}
  void reset() override {}
  geometry::Vector2 target(double, const geometry::Vector2&) override { return geometry::Vector2::Zero(); }
  bool finished(double time_s) const override { return over_() || time_s >= duration_s_; }

 private:
  std::function<bool()> over_;
  double duration_s_;
};

task::ActionConfig action_config(const CollectionConfig& config) {
  task::ActionConfig action;
  action.scale = config.rig.coils.max_current_A;
  return action;
}

/// A missing pose ends an episode at once: a gap in a recording is no transition.
control::ControlLoopConfig loop_config(const CollectionConfig& config) {
  control::ControlLoopConfig loop = config.loop;
  loop.max_invalid_poses = 1;
  return loop;
}

}  // namespace

data::DatasetInfo dataset_info(const CollectionConfig& config) {
  data::DatasetInfo info;
  info.layout = data::StateLayout::kPose;
  info.action_unit = "A";
  info.action_scale = config.rig.coils.max_current_A;
  info.workspace_radius_m = config.rig.dish.radius_m;
  info.control_period_s = config.loop.period_s();
  info.seed = config.seed;
  info.source = config.rig.real() ? "bench" : "virtual rig";
  info.rig = common::config_to_json<physics::RigDescription>(config.rig);
  return info;
}

std::unique_ptr<session::RigSession> make_exploration_session(const CollectionConfig& config,
                                                              std::int64_t session, bool realtime) {
  const auto seed = static_cast<std::uint64_t>(config.seed);
  const auto index = static_cast<std::uint64_t>(session);
  session::VirtualSeeds seeds;
  seeds.rig = static_cast<std::uint64_t>(config.rig_seed);
  seeds.scene = static_cast<std::uint64_t>(config.sensor_seed);
  seeds.sensor_noise = common::RandomStream(seed, "collect/sensor noise", index);
  // A single session is as it always was.
  if (session != 0) seeds.scatter = common::RandomStream(seed, "collect/scatter", index);
  return session::make_virtual_session(config.rig, config.sensor, config.safety, seeds, realtime);
}

Collection::Collection(const CollectionConfig& config, std::int64_t session)
    : Collection(config, make_exploration_session(config, session), std::nullopt, session) {}

Collection::Collection(const CollectionConfig& config, std::unique_ptr<session::RigSession> bench,
                       std::optional<Teleoperator> teleoperator, std::int64_t session)
    : config_(config),
      bench_(std::move(bench)),
      teleoperator_(std::move(teleoperator)),
      explorer_(config.explorer, config.rig.dish.radius_m,
                common::RandomStream(static_cast<std::uint64_t>(config.seed), "collect/explorer",
                                     static_cast<std::uint64_t>(session))) {}

data::Episode Collection::next_episode(std::int64_t max_steps) {
  max_steps = std::min(max_steps, config_.episode_steps);
  LODESTONE_CHECK(max_steps >= 1, "at least one step in an episode");
  for (int attempts = 0; attempts < 1000; ++attempts) {
    bench_->place(explorer_.next_start([this](const geometry::Pose2& pose) { return bench_->fits(pose); }));
    // Half a period less, as the loop counts time in sums of periods.
    UntilOver reference(
        teleoperator_ ? teleoperator_->episode_over : [this] { return explorer_.stuck(); },
        (static_cast<double>(max_steps) - 0.5) * config_.loop.period_s());
    const task::ActionConfig action =
        teleoperator_ && teleoperator_->action.scale > 0.0 ? teleoperator_->action : action_config(config_);
    control::ControlLoop loop(loop_config(config_), action, bench_->coils(), bench_->sensor(),
                              bench_->clock(), nullptr,
                              teleoperator_ ? teleoperator_->identifier.get() : nullptr);
    control::Controller& controller = teleoperator_ ? *teleoperator_->controller : explorer_;
    const control::LoopOutcome outcome = loop.run(
        controller, reference, teleoperator_ ? teleoperator_->watch : control::ControlLoop::Observer());
    if (common::interrupted()) throw common::Interrupted("collection stopped by the user");
    const bool latched = bench_->coils().latched();
    const bool lost = !latched && !outcome.steps.empty() && !outcome.steps.back().estimate.valid;
    if (!outcome.completed && !lost)
      throw common::HardwareError("collection stopped: " + outcome.stop_reason);
    const std::size_t observations = outcome.steps.size() - (lost ? 1 : 0);
    if (observations < 2) continue;
    data::Episode episode;
    for (std::size_t i = 0; i < observations; ++i) {
      const control::StepRecord& step = outcome.steps[i];
      const geometry::Pose2& pose = step.estimate.pose;
      episode.observations.insert(episode.observations.end(), {pose.x_m, pose.y_m, pose.heading_rad});
      if (i + 1 == observations) break;
      const geometry::Vector2 drive_A = task::axis_drive(step.action, action);
      episode.actions.insert(episode.actions.end(), {drive_A.x(), drive_A.y()});
      episode.terminations.push_back(0);
      episode.truncations.push_back(i + 2 == observations ? 1 : 0);
      episode.zero_current.push_back(drive_A.isZero(0.0) ? 1 : 0);
    }
    return episode;
  }
  throw common::HardwareError("collection stopped: the sensor gave no two poses in a row in 1000 attempts");
}

common::Json Collection::save() const {
  const session::GroundTruth* truth = bench_->truth();
  common::Json state = {{"bench", truth != nullptr ? truth->save() : common::Json()},
                        {"explorer", explorer_.save()}};
  if (teleoperator_ && teleoperator_->save) state["teleoperator"] = teleoperator_->save();
  return state;
}

void Collection::restore(const common::Json& state) {
  try {
    if (bench_->truth() != nullptr) bench_->truth()->load(state.at("bench"));
    explorer_.restore(state.at("explorer"));
    if (teleoperator_ && teleoperator_->restore)
      teleoperator_->restore(state.at("teleoperator").get<std::string>());
  } catch (const common::Json::exception& error) {
    throw common::DataError(std::string("collection state is malformed: ") + error.what());
  }
}

}  // namespace lodestone::experiments
