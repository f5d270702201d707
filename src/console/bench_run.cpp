#include "bench_core.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "lodestone/common/random.h"
#include "lodestone/console/drawn_path.h"
#include "lodestone/control/suture_reference.h"
#include "lodestone/experiments/suture.h"

namespace lodestone::console {

namespace {
constexpr double kKeep_s = 600.0;    // of samples
constexpr std::size_t kTrail = 200;  // poses
constexpr double kForGood_s = 1e9;   // a target is held until somebody ends the run
}  // namespace

std::shared_ptr<control::Reference> Bench::State::reference_of(const Goal& to, bool unattended) {
  routed.reset();
  if (!to.stitches.empty())
    return std::make_shared<control::SutureReference>(to.stitches,
                                                      experiments::suture_reference(parts.config));
  if (to.path) return std::make_shared<control::PathReference>(*to.path, parts.config.reference);
  const auto point = std::make_shared<control::PointReference>(
      to.target_m, unattended ? parts.config.trials.point_seconds : kForGood_s, to.heading_rad);
  if (!parts.routes || to.task == kHand) return point;
  routed = std::make_shared<control::RoutedReference>(
      point, parts.routes, shown.keep_out,
      std::max(parts.config.route.waypoint_radius_m, parts.config.decorators.hold_radius_m));
  return routed;
}

const experiments::ControllerSource& Bench::State::source(const std::string& name) const {
  const auto found = std::find_if(parts.sources.begin(), parts.sources.end(),
                                  [&](const auto& source) { return source.name == name; });
  return found == parts.sources.end() ? parts.sources.front() : *found;
}

void Bench::State::follow(const Goal& to) {
  const bool by_hand = to.task == kHand;
  std::string name;
  {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    name = shown.controller;
  }
  const experiments::ControllerSource& driver = source(name);
  std::shared_ptr<control::RigIdentifier>& identifier = identifiers[driver.name];
  if (!identifier && driver.identify)
    identifier = driver.identify();  // what it finds out, the next run knows
  task::ActionConfig by_hand_action;
  by_hand_action.scale = parts.config.rig.coils.max_current_A;
  by_hand_action.size = parts.config.rig.drive_size();
  const std::unique_ptr<control::Controller> made =
      by_hand ? nullptr
              : driver.make(common::derive_seed(static_cast<std::uint64_t>(parts.config.seed), "console run",
                                                ++runs));
  control::Controller& controller = by_hand ? static_cast<control::Controller&>(hand) : *made;
  // By hand, nothing moves the needle but the hand: no probes.
  const auto running = std::make_shared<control::ControlLoop>(
      parts.config.loop, by_hand ? by_hand_action : driver.action, *pulses, session->sensor(),
      session->clock(), by_hand ? nullptr : &parts.config.rig, by_hand ? nullptr : identifier.get());
  if (by_hand) running->drive_with(physics::CoilDrive(parts.config.rig));
  running->forget_steps();
  {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    if (std::exchange(cancelled, true) || over || shown.mode != Mode::kArmed) return;
    shown.unattended = !by_hand && std::exchange(unattended_next, false);
    const auto driving = by_hand            ? Driving::kByHand
                         : shown.unattended ? Driving::kUnattended
                                            : Driving::kAttended;
    attendance.begin(driving);
    shown.attended = !shown.unattended;
    shown.mode = Mode::kRunning;
    shown.run = BenchRun{to.task};
    aim(to);
    ending = Ending::kNone;
    end_wanted.reset();
    loop = running;
    reference = std::make_shared<control::SteeredReference>(reference_of(to, shown.unattended));
    pulses->begin_run();
  }
  tell(Level::kInfo, "run begins: " + to.task + ", " + name);
  const control::LoopOutcome outcome =
      running->run(controller, *reference, [this](const control::StepRecord& step) { note(step); });
  finish(outcome);
}

void Bench::State::aim(const Goal& to) {
  const bool point = !to.path && to.task != kHand;
  shown.run->task = to.task;
  shown.run->aimed_s = shown.run->time_s;
  shown.target_heading_rad = point ? to.heading_rad : std::nullopt;
  show(to.path);
  shown.target_m = point ? std::optional(to.target_m) : std::nullopt;
}

void Bench::State::show(const std::optional<geometry::Path>& path) {
  shown.plan_m = path ? path->points_m() : std::vector<geometry::Vector2>{};
  shown.plan_headings = path ? shown_headings(*path) : std::vector<geometry::Pose2>{};
}

void Bench::State::note(const control::StepRecord& step) {
  const std::lock_guard<common::PriorityMutex> lock(mutex);
  note_camera();
  shown.pose = step.estimate;
  if (step.estimate.valid) remember(step.estimate.pose.position_m());
  // A point that was asked for stays the target that is shown, wherever the needle is led over on its way.
  if (attendance.driving() != Driving::kByHand && !shown.plan_m.empty()) {
    shown.target_m = step.target_m;
    shown.target_heading_rad = step.target_heading_rad;
  }
  shown.run->time_s = step.time_s;
  ++shown.run->steps;
  last_A = step.current_A;
  reported = session->coils().reported();
  note_zones(session->coils().keep_out());
  add_sample(step.estimate, shown.target_m);
}

void Bench::State::note_zones(std::vector<geometry::Zone> zones) {
  if (zones == shown.keep_out.zones) return;
  if (routed) routed->move_zones(zones);
  shown.keep_out.zones = std::move(zones);
}

void Bench::State::finish(const control::LoopOutcome& outcome) {
  std::string reason = outcome.stop_reason;
  Ending how = Ending::kNone;
  {
    const std::lock_guard<common::PriorityMutex> lock(mutex);
    how = ending;
    attendance.end();
    loop.reset();
    reference.reset();
    routed.reset();
    shown.run.reset();
    shown.unattended = shown.attended = false;
    shown.target_m.reset();
    last_A.assign(last_A.size(), 0.0);
    if (shown.mode == Mode::kRunning && (outcome.completed || how == Ending::kByOperator))
      shown.mode = Mode::kArmed;
  }
  if (outcome.completed) return tell(Level::kInfo, "run ended: done");
  if (how != Ending::kStopped && session->coils().latched()) return stop(session->coils().reason());
  if (how == Ending::kByOperator) return tell(Level::kInfo, "run ended: " + reason);
  if (how == Ending::kStopped) return;  // who stopped it has told
  stop(reason);
}

void Bench::State::remember(const geometry::Vector2& position_m) {
  if (!shown.trail_m.empty() && (shown.trail_m.back() - position_m).norm() < 1e-4) return;
  shown.trail_m.push_back(position_m);
  if (shown.trail_m.size() > kTrail) shown.trail_m.erase(shown.trail_m.begin());
}

void Bench::State::add_sample(const control::PoseEstimate& estimate,
                              const std::optional<geometry::Vector2>& target_m) {
  BenchSample sample;
  sample.time_s = now();
  if (estimate.valid) {
    sample.pose = estimate.pose;
    sample.pose_age_ms = std::max(0.0, 1e3 * (sample.time_s - estimate.stamp_s));
    if (target_m) sample.error_mm = geometry::kMmPerM * (*target_m - estimate.pose.position_m()).norm();
  }
  sample.target_m = target_m;
  sample.current_A = last_A;
  sample.duty = pulses->duty(sample.time_s);
  if (const auto jitter_s = pulses->jitter_s()) sample.jitter_ms = 1e3 * *jitter_s;
  if (reported) {
    sample.temperature_C = reported->temperature_C;
    sample.supply_V = reported->supply_V;
  }
  shown.sample = sample;
  ++shown.samples;
  samples.push_back(sample);
  while (samples.front().time_s < sample.time_s - kKeep_s) samples.pop_front();
}

}  // namespace lodestone::console
