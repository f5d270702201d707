#include "lodestone/experiments/collection.h"

#include <algorithm>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"

namespace lodestone::experiments {

namespace {

/// What has become of the needle in one run of the loop.
struct Sight {
  bool lost = false;
  bool found = false;  ///< after it was lost
};

/// No target, only an end: after some steps, or when something says so. A needle that is lost is looked for
/// first, and the end is when it is found.
class UntilOver final : public control::Reference {
 public:
  UntilOver(std::function<bool()> over, double duration_s, const Sight& sight)
      : over_(std::move(over)), duration_s_(duration_s), sight_(sight) {}
  void reset() override {}
  geometry::Vector2 target(double, const geometry::Pose2&) override { return geometry::Vector2::Zero(); }
  bool finished(double time_s) const override {
    return sight_.lost ? sight_.found : over_() || time_s >= duration_s_;
  }

 private:
  std::function<bool()> over_;
  double duration_s_;
  const Sight& sight_;
};

/// A controller up to where the needle is lost.
class WhileSeen final : public control::Controller {
 public:
  WhileSeen(control::Controller& inner, Sight& sight) : inner_(inner), sight_(sight) {}
  void reset() override { inner_.reset(); }
  geometry::Drive act(const task::Observation& observation) override {
    sight_.found = sight_.lost;
    return sight_.lost ? observation.rest() : inner_.act(observation);
  }

 private:
  control::Controller& inner_;
  Sight& sight_;
};

task::ActionConfig action_config(const CollectionConfig& config) {
  task::ActionConfig action;
  action.scale = config.rig.coils.max_current_A;
  action.size = config.rig.drive_size();
  return action;
}

/// Where an operator is at hand, nobody looks for a needle that is lost.
control::ControlLoopConfig loop_config(const CollectionConfig& config) {
  control::ControlLoopConfig loop = config.loop;
  if (!config.explorer.self_reset) loop.max_invalid_poses = 1;
  return loop;
}

data::StateLayout layout_of(const CollectionConfig& config) {
  return config.rig.needle.is_sphere() ? data::StateLayout::kPosition : data::StateLayout::kPose;
}

/// The pulses up to the first pose that is missing: a gap in a recording is no transition.
data::Episode episode_of(const std::vector<control::StepRecord>& steps, const task::ActionConfig& action,
                         data::StateLayout layout) {
  const auto gap = std::find_if(steps.begin(), steps.end(),
                                [](const control::StepRecord& step) { return !step.estimate.valid; });
  data::Episode episode;
  for (auto step = steps.begin(); step != gap; ++step) {
    const geometry::Pose2& pose = step->estimate.pose;
    episode.observations.insert(episode.observations.end(), {pose.x_m, pose.y_m});
    if (layout == data::StateLayout::kPose) episode.observations.push_back(pose.heading_rad);
    if (step + 1 == gap) break;
    const geometry::Drive drive_A = task::drive_of(step->action, action);
    episode.actions.insert(episode.actions.end(), drive_A.begin(), drive_A.end());
    episode.terminations.push_back(0);
    episode.truncations.push_back(step + 2 == gap ? 1 : 0);
    episode.zero_current.push_back(drive_A.isZero(0.0) ? 1 : 0);
  }
  return episode;
}

}  // namespace

data::DatasetInfo dataset_info(const CollectionConfig& config) {
  data::DatasetInfo info;
  info.layout = layout_of(config);
  info.action_unit = "A";
  info.action_scale = config.rig.coils.max_current_A;
  info.action_size = config.rig.drive_size();
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
      explorer_(config.explorer, config.rig,
                common::RandomStream(static_cast<std::uint64_t>(config.seed), "collect/explorer",
                                     static_cast<std::uint64_t>(session))),
      to_be_placed_(!config.explorer.self_reset) {}

task::ActionConfig Collection::action() const {
  return teleoperator_ && teleoperator_->action.scale > 0.0 ? teleoperator_->action : action_config(config_);
}

control::LoopOutcome Collection::run(std::int64_t max_steps) {
  const std::function<bool()> over =
      teleoperator_ ? teleoperator_->episode_over : [this] { return explorer_.needs_operator(); };
  control::Controller& controller = teleoperator_ ? *teleoperator_->controller : explorer_;
  Sight sight;
  // Half a period less, as the loop counts time in sums of periods.
  UntilOver reference(over, (static_cast<double>(max_steps) - 0.5) * config_.loop.period_s(), sight);
  WhileSeen seeing(controller, sight);
  control::ControlLoop loop(loop_config(config_), action(), bench_->coils(), bench_->sensor(),
                            bench_->clock(), config_.explorer.self_reset ? &config_.rig : nullptr,
                            teleoperator_ ? teleoperator_->identifier.get() : nullptr);
  loop.drive_with(physics::CoilDrive(config_.rig));
  const control::LoopOutcome outcome = loop.run(seeing, reference, [&](const control::StepRecord& step) {
    sight.lost = sight.lost || !step.estimate.valid;
    if (teleoperator_ && teleoperator_->watch) teleoperator_->watch(step);
    if (log_) log_->step(step, {});
  });
  if (!outcome.completed) note(exports::LogLevel::kError, "stopped: " + outcome.stop_reason);
  if (common::interrupted()) throw common::Interrupted("collection stopped by the user");
  const bool gone = !outcome.completed && !bench_->coils().latched() && !outcome.steps.empty() &&
                    !outcome.steps.back().estimate.valid;
  if (!outcome.completed && !gone) throw common::HardwareError("collection stopped: " + outcome.stop_reason);
  to_be_placed_ = !config_.explorer.self_reset || gone || over();
  return outcome;
}

data::Episode Collection::next_episode(std::int64_t max_steps) {
  max_steps = std::min(max_steps, config_.episode_steps);
  LODESTONE_CHECK(max_steps >= 1, "at least one step in an episode");
  bench_->sensor().forget();  // what it remembers would not be there after a restart
  std::int64_t placements = 0;
  for (int attempts = 0; attempts < 1000; ++attempts) {
    if (to_be_placed_) {
      bench_->place(explorer_.next_start([this](const geometry::Pose2& pose) { return bench_->fits(pose); }));
      explorer_.placed();
      ++placements;
      note(exports::LogLevel::kInfo, "the operator has placed the needle");
    }
    data::Episode episode = episode_of(run(max_steps).steps, action(), layout_of(config_));
    if (episode.length() == 0) continue;
    episode.placements = placements;
    note(exports::LogLevel::kInfo, "an episode of " + std::to_string(episode.length()) + " steps has ended");
    if (log_) log_->flush();
    return episode;
  }
  throw common::HardwareError("collection stopped: the sensor gave no two poses in a row in 1000 attempts");
}

void Collection::log_into(const std::string& path, const McapConfig& config) {
  log_.emplace(path, config,
               std::map<std::string, std::string>{
                   {"rig", common::config_to_json<physics::RigDescription>(config_.rig).dump()}},
               StepLog::Sources{bench_->clock(), bench_->coils(), bench_->camera()});
}

void Collection::finish_log() {
  if (log_) log_->finish();
}

void Collection::note(exports::LogLevel level, const std::string& text) {
  if (log_) log_->event(level, text);
}

common::Json Collection::save() const {
  const session::GroundTruth* truth = bench_->truth();
  common::Json state = {{"bench", truth != nullptr ? truth->save() : common::Json()},
                        {"explorer", explorer_.save()},
                        {"to_be_placed", to_be_placed_}};
  if (teleoperator_ && teleoperator_->save) state["teleoperator"] = teleoperator_->save();
  return state;
}

void Collection::restore(const common::Json& state) {
  try {
    if (bench_->truth() != nullptr) bench_->truth()->load(state.at("bench"));
    explorer_.restore(state.at("explorer"));
    if (bench_->truth() != nullptr)
      to_be_placed_ = state.at("to_be_placed").get<bool>();
    else
      explorer_.placed();  // whoever starts it again has seen to the needle
    if (teleoperator_ && teleoperator_->restore)
      teleoperator_->restore(state.at("teleoperator").get<std::string>());
  } catch (const common::Json::exception& error) {
    throw common::DataError(std::string("collection state is malformed: ") + error.what());
  }
}

}  // namespace lodestone::experiments
