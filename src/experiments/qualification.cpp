#include "lodestone/experiments/qualification.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lodestone/common/artefact.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/random.h"
#include "lodestone/common/statistics.h"
#include "lodestone/experiments/qualification_verdict.h"
#include "lodestone/task/task.h"

namespace lodestone::experiments {
namespace {

constexpr std::size_t kStillLooks = 300;
constexpr std::size_t kRounds = 5;  // of pulses through every coil
constexpr double kCurrentPulse_s = 0.2;
constexpr double kPoll_s = 2e-3;         // between reports of a current
constexpr std::size_t kSamePulses = 10;  // at the beginning, and at the end,
constexpr std::int64_t kSameTries = 20;  // of so many tries
constexpr std::int64_t kLatencyPulses = 20;
constexpr double kMotionWithin_s = 0.6;   // of a pulse
constexpr std::int64_t kVisits = 80;      // while it roams
constexpr double kPointsShare = 0.4;      // of all the time, at most
constexpr double kGoldenPart = 0.618034;  // multiples of it are spread evenly between whole numbers

// Places, in dish radii.
constexpr double kInside = 0.5;
constexpr double kStartAt = -0.25;  // of the same pulse, along x
constexpr double kRoam = 0.8;
constexpr double kTooFar = 0.85;

constexpr double kAlike_m = 2e-3;     // starts of the same pulse
constexpr double kAbout_m = 4e-3;     // any other place
constexpr double kAlignedBy_A = 1.5;  // as pulses that turn a needle and hardly pull (FreeingConfig)

constexpr double kWeakest = 0.15;  // of the pull that should break the needle loose
constexpr double kStronger = 1.4;  // from level to level
constexpr int kPulsesOfLevel = 12;
constexpr std::int64_t kFarLevels = 2;
constexpr double kFarEnough_m = 1e-3;  // that all pulses of such levels move the needle on average

struct AxisDrive {
  double x, y;
  std::size_t coil;  // of opposed pairs
};
constexpr std::array<AxisDrive, 4> kAxisDrives = {
    {{1.0, 0.0, 0}, {0.0, 1.0, 2}, {-1.0, 0.0, 1}, {0.0, -1.0, 3}}};

/// The middle, then by turns nearer and further out, all around: a measurement that is cut short has seen
/// every side.
std::vector<geometry::Vector2> weak_places_m(double radius_m) {
  std::vector<geometry::Vector2> places(1, geometry::Vector2::Zero());
  for (int i = 0; i < 8; ++i) {
    const double angle_rad = (0.125 + 0.375 * i) * 2.0 * geometry::kPi;
    const double at_m = (i % 2 == 0 ? 0.35 : 0.6) * radius_m;
    places.emplace_back(at_m * std::cos(angle_rad), at_m * std::sin(angle_rad));
  }
  return places;
}

}  // namespace

void QualificationConfig::validate() const {
  rig.validate();
  if (safety.has_zones())
    throw common::ConfigError(
        "safety.keep_out, safety.keep_out_file: a qualification drives all over the dish, and knows no way "
        "around zones; take away "
        "what stands there, and leave the zones out");
}

DeployConfig QualificationConfig::deploy() const {
  DeployConfig config;
  config.policy = points.policy;
  config.dynamics = points.dynamics;
  config.controller = points.driven_by();
  config.task = "point";
  DeploymentConfig& deployment = config.deployment;
  deployment.seed = seed;
  deployment.rig_seed = rig_seed;
  deployment.sensor_seed = sensor_seed;
  deployment.trials.count = points.count;
  deployment.trials.point_seconds = points.seconds;
  deployment.loop = needle.loop;
  deployment.safety = safety;
  deployment.decorators = points.decorators;
  deployment.baseline = needle.baseline;
  deployment.planner = points.planner;
  deployment.identification = points.identification;
  deployment.rig = rig;
  deployment.sensor = sensor;
  return config;
}

ControllerSource points_source(const QualificationConfig& config) {
  return plan_job(config.deploy()).sources.front();
}

std::unique_ptr<session::RigSession> make_qualification_session(const QualificationConfig& config) {
  const auto seed = static_cast<std::uint64_t>(config.seed);
  session::VirtualSeeds seeds;
  seeds.rig = static_cast<std::uint64_t>(config.rig_seed);
  seeds.scene = static_cast<std::uint64_t>(config.sensor_seed);
  seeds.sensor_noise = common::RandomStream(seed, "qualify/sensor noise");
  seeds.scatter = common::RandomStream(seed, "qualify/scatter");
  return session::make_virtual_session(config.rig, config.sensor, config.safety, seeds);
}

Qualification::Qualification(const QualificationConfig& config, session::RigSession& bench,
                             ControllerSource driver)
    : config_(config),
      bench_(bench),
      deployment_(config.deploy().deployment),
      driver_(std::move(driver)),
      needle_(config.needle, config.rig, bench),
      pull_(config.rig),
      start_s_(bench.clock().now_s()) {
  state_.rises.resize(config.rig.coils.count());
}

/// Each ends before its time where it has all that it wants. What drives to points is less known than the
/// rest, and may end a qualification: it comes last.
const std::vector<Qualification::Item>& Qualification::items() {
  static const std::vector<Item> kItems = {{"still needle", 0.04, &Qualification::lie_still_at_first},
                                           {"coils", 0.14, &Qualification::measure_coils},
                                           {"same pulse", 0.26, &Qualification::repeat_pulse_at_first},
                                           {"latency", 0.34, &Qualification::measure_latency},
                                           {"weak pulses", 0.66, &Qualification::push_weakly},
                                           {"refusals", 0.83, &Qualification::roam},
                                           {"same pulse again", 0.95, &Qualification::repeat_pulse_at_end},
                                           {"still needle again", 1.0, &Qualification::lie_still_at_end},
                                           {"points", 1.0, &Qualification::drive_to_point}};
  return kItems;
}

double Qualification::passed_s() const { return bench_.clock().now_s() - start_s_; }

bool Qualification::ended() const { return static_cast<std::size_t>(state_.item) == items().size(); }

double Qualification::point_s() const { return config_.points.seconds + config_.needle.loop.period_s(); }

/// Of all trials, or of as many as fit into their share.
double Qualification::points_s() const {
  const double fit = std::floor(kPointsShare * 60.0 * config_.minutes / point_s());
  return point_s() * std::min(fit, static_cast<double>(config_.points.count));
}

bool Qualification::time_left(double needed_s) const {
  const Item& item = items()[static_cast<std::size_t>(state_.item)];
  const double all_s = 60.0 * config_.minutes;
  const double shared_s = &item == &items().back() ? all_s : all_s - points_s();
  return passed_s() + needed_s < item.until * shared_s;
}

runs::Progress Qualification::progress() const {
  const std::int64_t total_s = std::llround(60.0 * config_.minutes);
  if (ended()) return {total_s, total_s, true, ""};
  const std::int64_t done_s = std::llround(passed_s());
  return {std::min(done_s, total_s), total_s, stopped_.has_value(),
          stopped_ ? "stopped" : items()[static_cast<std::size_t>(state_.item)].name};
}

void Qualification::step(common::MetricsLog& /*metrics*/) {
  if (progress().finished) return;
  try {
    measure_piece();
  } catch (const common::Error& error) {
    stopped_ = error.what();
  } catch (...) {
    bench_.coils().stop();
    throw;
  }
  if (!stopped_ && !ended() && common::interrupted()) stopped_ = "stopped by the user (signal)";
  if (progress().finished) bench_.coils().stop();
}

void Qualification::measure_piece() {
  if (!begun_) begin_item();
  const Item& item = items()[static_cast<std::size_t>(state_.item)];
  if (time_left() && (this->*item.measure)())
    ++state_.pieces;
  else
    end_item();
  // Within an item a virtual bench's sensor knows things that would not be there after a restart.
  if (bench_.truth() == nullptr || !begun_) keep();
}

void Qualification::begin_item() {
  begun_ = true;
  at_place_ = false;
  needle_.begin();
  if (!needle_.here()) needle_.bring_to(geometry::Vector2::Zero(), kAbout_m);  // looks for it
}

void Qualification::end_item() {
  if (state_.item == 0) state_.first_C = temperatures_C();
  ++state_.item;
  state_.pieces = 0;
  begun_ = false;
  if (ended()) state_.last_C = temperatures_C();
}

void Qualification::keep() {
  state_.passed_s = passed_s();
  state_.saved_s = common::unix_time_s();
  state_.refusals = needle_.refusals().counts();
  if (const session::GroundTruth* truth = bench_.truth()) state_.bench = truth->save();
  unsaved_ = state_;
}

void Qualification::save(const std::string& folder) {
  if (!unsaved_) return;
  common::write_artefact(folder + QualificationState::kFile, *unsaved_);
  unsaved_.reset();
}

void Qualification::load(const std::string& folder) {
  const std::string path = folder + QualificationState::kFile;
  std::optional<QualificationState> found = common::find_artefact<QualificationState>(path);
  if (!found) return;
  const bool fits = found->item >= 0 && found->item <= static_cast<std::int64_t>(items().size()) &&
                    found->pieces >= 0 && found->rises.size() == config_.rig.coils.count();
  if (!fits)
    throw common::DataError(path + ": piece " + std::to_string(found->pieces) + " of item " +
                            std::to_string(found->item) + " with " + std::to_string(found->rises.size()) +
                            " coils is nothing that this bench goes on from; start again in another folder");
  for (const double error_mm : found->points_mm)
    if (!(error_mm >= 0.0))  // null is read as not a number
      throw common::DataError(path + ": points_mm holds no distance in one of its " +
                              std::to_string(found->points_mm.size()) +
                              " trials; the file is damaged: start again in another folder");
  state_ = std::move(*found);
  needle_.restore_refusals(state_.refusals);
  if (state_.still) threshold_ = motion_threshold(*state_.still);
  if (session::GroundTruth* truth = bench_.truth()) {
    try {
      truth->load(state_.bench);
    } catch (const common::Json::exception& error) {
      throw common::DataError(path + ": bench is malformed: " + error.what());
    }
    return;
  }
  start_s_ = bench_.clock().now_s() - state_.passed_s;
  if (!ended()) note_gap();
}

void Qualification::note_gap() {
  runs::QualificationGap gap;
  gap.after_min = state_.passed_s / 60.0;
  gap.away_min = std::max(0.0, common::unix_time_s() - state_.saved_s) / 60.0;
  for (std::size_t item = 0; item < static_cast<std::size_t>(state_.item); ++item)
    gap.before.emplace_back(items()[item].name);
  if (state_.pieces > 0) gap.across = items()[static_cast<std::size_t>(state_.item)].name;
  state_.gaps.push_back(std::move(gap));
}

bool Qualification::lie_still_at_first() {
  state_.still = lie_still();
  if (state_.still) threshold_ = motion_threshold(*state_.still);
  return false;
}

bool Qualification::lie_still_at_end() {
  state_.still_at_end = lie_still();
  return false;
}

std::optional<runs::StillFigures> Qualification::lie_still() {
  std::vector<StillLook> looks;
  std::int64_t refused = 0;
  while (looks.size() < kStillLooks && time_left()) {
    const control::PoseEstimate seen = needle_.fresh_look();
    if (!seen.valid) {
      ++refused;
      continue;
    }
    looks.push_back({seen.pose, seen.position_covariance_m2, seen.heading_sigma_rad, seen.stamp_s});
  }
  return still_figures(looks, refused);
}

std::vector<double> Qualification::temperatures_C() { return bench_.coils().status().temperature_C.list(); }

double Qualification::largest_A() const {
  return std::min(config_.rig.coils.max_current_A, config_.safety.max_current_A);
}

double Qualification::test_current_of(std::size_t coil) const {
  return std::min({config_.test_current_A, config_.rig.coils.largest_A(coil), config_.safety.max_current_A});
}

void Qualification::keep_inside() {
  const std::optional<geometry::Pose2> here = needle_.here();
  if (!here || here->position_m().norm() > kInside * config_.rig.dish.radius_m)
    needle_.bring_to(geometry::Vector2::Zero(), kAbout_m);
}

bool Qualification::measure_coils() {
  const std::size_t coils = state_.rises.size();
  const auto pulse = static_cast<std::size_t>(state_.pieces);
  if (pulse >= kRounds * coils) return false;
  keep_inside();
  if (needle_.here()) measure_coil(pulse % coils);
  return true;
}

void Qualification::measure_coil(std::size_t coil) {
  common::Clock& clock = bench_.clock();
  rig::CoilPulse pulse;
  pulse.current_A.assign(config_.rig.coils.count(), 0.0);
  pulse.current_A[coil] = test_current_of(coil);
  pulse.duration_s = std::min(kCurrentPulse_s, config_.safety.max_pulse_s);
  if (pulse.current_A[coil] <= 0.0) return;
  std::vector<CurrentSample> samples;
  const double start_s = clock.now_s();
  needle_.pulse(pulse);
  for (double asked_s = clock.now_s(); asked_s - start_s < pulse.duration_s; asked_s = clock.now_s()) {
    const rig::CoilStatus status = bench_.coils().status();
    const double after_s = 0.5 * (asked_s + clock.now_s()) - start_s;
    if (status.current_A.size() > coil && after_s < pulse.duration_s)
      samples.push_back({after_s, status.current_A[coil]});
    clock.sleep_until(clock.now_s() + kPoll_s);
  }
  needle_.rest();
  state_.reports += static_cast<std::int64_t>(samples.size());
  if (const auto rise = current_rise(samples, pulse.current_A[coil])) state_.rises[coil].push_back(*rise);
}

bool Qualification::repeat_pulse_at_first() { return repeat_pulse(state_.early); }

bool Qualification::repeat_pulse_at_end() { return repeat_pulse(state_.late); }

bool Qualification::repeat_pulse(std::vector<PulseMotion>& pulses) {
  if (state_.pieces >= kSameTries || pulses.size() >= kSamePulses) return false;
  const geometry::Vector2 start_m(kStartAt * config_.rig.dish.radius_m, 0.0);
  geometry::Drive drive_A = pull_.drive_A({config_.rig.breakaway_N(), 0.0}, start_m);
  if (drive_A.isZero(0.0))
    drive_A = physics::CoilDrive(config_.rig).along({config_.test_current_A, 0.0}, start_m);
  drive_A *= std::min(1.0, largest_A() / drive_A.cwiseAbs().maxCoeff());
  const geometry::Vector2 across_A(0.0, std::min(kAlignedBy_A, largest_A()));
  if (!needle_.bring_to(start_m, kAlike_m)) return true;
  if (!needle_.push_along(across_A) || !needle_.push_along(across_A)) return true;
  if (const std::optional<PulseMotion> motion = needle_.push(drive_A)) pulses.push_back(*motion);
  return true;
}

bool Qualification::measure_latency() {
  if (state_.pieces >= kLatencyPulses) return false;
  keep_inside();
  if (!needle_.here()) return true;
  const double phase = kGoldenPart * static_cast<double>(state_.pieces);
  if (!time_motion(phase - std::floor(phase))) ++state_.unseen;
  needle_.rest();
  return true;
}

bool Qualification::time_motion(double part) {
  const std::optional<geometry::Pose2> before = needle_.here();
  if (!before) return false;
  // The field across the needle moves it first.
  const geometry::Vector2 across(-std::sin(before->heading_rad), std::cos(before->heading_rad));
  const auto better = [&across](const AxisDrive& a, const AxisDrive& b) {
    return a.x * across.x() + a.y * across.y() < b.x * across.x() + b.y * across.y();
  };
  const AxisDrive& drive = *std::max_element(kAxisDrives.begin(), kAxisDrives.end(), better);
  const double current_A = std::min(config_.test_current_A, largest_A());
  const rig::CoilPulse pulse =
      needle_.pulse_along(current_A * geometry::Vector2(drive.x, drive.y), before->position_m());
  common::Clock& clock = bench_.clock();
  clock.sleep_until(clock.now_s() + part * config_.needle.look_s);
  const double start_s = clock.now_s();
  needle_.pulse(pulse);
  while (clock.now_s() < start_s + kMotionWithin_s) {
    const control::PoseEstimate seen = needle_.look_during(pulse);
    if (!seen.valid || seen.stamp_s < start_s || !threshold_.moved(*before, seen.pose)) continue;
    state_.moved_s.push_back(seen.stamp_s - start_s);
    state_.looks_s.push_back(needle_.look_during(pulse).stamp_s - seen.stamp_s);
    return true;
  }
  return false;
}

double Qualification::weak_current_A(const geometry::Vector2& at_m) const {
  const geometry::Vector2 inwards =
      at_m.isZero(0.0) ? geometry::Vector2(1.0, 0.0) : geometry::Vector2(-at_m.normalized());
  const geometry::Drive described_A = pull_.drive_A(config_.rig.breakaway_N() * inwards, at_m);
  double current_A = kWeakest * (described_A.isZero(0.0) ? largest_A() : described_A.cwiseAbs().maxCoeff());
  for (std::int64_t level = 0; level < state_.weak_progress.level; ++level) current_A *= kStronger;
  return current_A;
}

bool Qualification::push_weakly() {
  WeakPulsesProgress& at = state_.weak_progress;
  const std::vector<geometry::Vector2> places_m = weak_places_m(config_.rig.dish.radius_m);
  if (static_cast<std::size_t>(at.place) >= places_m.size()) return false;
  const geometry::Vector2& at_m = places_m[static_cast<std::size_t>(at.place)];
  const double current_A = weak_current_A(at_m);
  const bool all_levels = current_A > largest_A() || at.far_levels >= kFarLevels;
  if (!all_levels && !at_place_) at_place_ = needle_.bring_to(at_m, kAbout_m);
  if (all_levels || !at_place_) {
    at = {at.place + 1, 0, 0};
    at_place_ = false;
    return true;
  }
  at.far_levels = push_level(at_m, current_A) ? at.far_levels + 1 : 0;
  ++at.level;
  return true;
}

bool Qualification::push_level(const geometry::Vector2& at_m, double current_A) {
  const bool pairs = config_.rig.drive.kind == physics::DriveKind::kOpposedPairs;
  int pulses = 0, moved = 0;
  double way_m = 0.0;
  for (int i = 0; i < kPulsesOfLevel; ++i) {
    if (!time_left()) return false;
    const std::optional<geometry::Pose2> here = needle_.here();
    if (!here || here->position_m().norm() > kTooFar * config_.rig.dish.radius_m)
      needle_.bring_to(at_m, kAbout_m);
    const AxisDrive& axis = kAxisDrives[static_cast<std::size_t>(i) % kAxisDrives.size()];
    const std::optional<PulseMotion> motion =
        needle_.push_along(current_A * geometry::Vector2(axis.x, axis.y));
    if (!motion) continue;
    WeakPulse weak;
    weak.place = static_cast<std::size_t>(state_.weak_progress.place);
    weak.level = static_cast<std::size_t>(state_.weak_progress.level);
    weak.current_A = current_A;
    if (pairs) weak.coil = axis.coil;
    weak.drive_rad = std::atan2(axis.y, axis.x);
    weak.motion = *motion;
    weak.moved = threshold_.moved(motion->before, motion->after);
    state_.weak.push_back(weak);
    ++pulses;
    moved += weak.moved ? 1 : 0;
    way_m += motion->step_m().norm();
  }
  return pulses > 0 && moved == pulses && way_m >= kFarEnough_m * pulses;
}

bool Qualification::roam() {
  if (state_.pieces >= kVisits) return false;
  common::RandomStream random(static_cast<std::uint64_t>(config_.seed), "qualify/places");
  geometry::Vector2 place_m = geometry::Vector2::Zero();
  for (std::int64_t visit = 0; visit <= state_.pieces; ++visit)
    place_m = task::draw_in_disc(kRoam * config_.rig.dish.radius_m, random);
  needle_.bring_to(place_m, kAbout_m);
  return true;
}

bool Qualification::drive_to_point() {
  if (state_.pieces >= config_.points.count || !time_left(point_s())) return false;
  const auto fits = [this](const geometry::Pose2& pose) { return bench_.fits(pose); };
  const TrialPlan plan = plan_trial(deployment_, "point", state_.pieces, std::nullopt, std::nullopt, fits);
  const TrialResult trial = run_on_session(bench_, deployment_, plan, driver_);
  if (!trial.completed && bench_.coils().latched()) throw common::HardwareError(trial.stop_reason);
  if (trial.completed)
    state_.points_mm.push_back(trial.sensed.final_error_mm);
  else
    ++state_.points_failed;
  return true;
}

std::vector<runs::CoilFigures> Qualification::measured_coils() const {
  const physics::CoilsDescription& coils = config_.rig.coils;
  std::vector<std::string> names;
  for (std::size_t coil = 0; coil < coils.count(); ++coil) names.push_back(coils.name(coil));
  std::vector<runs::CoilFigures> figures_by_coil = coil_figures(names, state_.rises);
  const auto by_motion = gains_by_motion(state_.weak, 0, coils.count());
  for (std::size_t coil = 0; coil < coils.count(); ++coil) {
    runs::CoilFigures& figures = figures_by_coil[coil];
    figures.gain_by_motion = by_motion[coil];
    if (coil < state_.first_C.size()) figures.first_C = state_.first_C[coil];
    if (coil < state_.last_C.size()) figures.last_C = state_.last_C[coil];
    if (!figures.gain)
      figures.why = state_.reports == 0 ? "currents: not measured, as the coils report none while they are on"
                                        : "currents: not measured, as none was seen to rise in this coil";
    if (!figures.gain_by_motion)
      figures.why += std::string(figures.why.empty() ? "" : "; ") +
                     (config_.rig.drive.kind == physics::DriveKind::kOpposedPairs
                          ? "gain by motion: not measured, as no weak pulse of this coil moved the needle"
                          : "gain by motion: not measured, as drives of this rig share several coils");
  }
  return figures_by_coil;
}

runs::QualificationResult Qualification::result() const {
  runs::QualificationResult result;
  result.dish_radius_mm = geometry::kMmPerM * config_.rig.dish.radius_m;
  result.minutes = passed_s() / 60.0;
  result.stopped = stopped_;
  result.gaps = state_.gaps;
  result.still = state_.still;
  result.still_at_end = state_.still_at_end;
  const runs::RefusalFigures refusals = needle_.refusals().figures();
  if (refusals.share.n > 0) result.refusals = refusals;
  result.latency = latency_figures(state_.moved_s, common::median(state_.looks_s), state_.unseen);
  std::vector<PulseMotion> pulses = state_.early;
  pulses.insert(pulses.end(), state_.late.begin(), state_.late.end());
  result.same_pulse = same_pulse_figures(pulses);
  result.step_change = step_change(state_.early, state_.late);
  result.coils = measured_coils();
  if (state_.still) result.stick_slip = stick_slip_figures(state_.weak, sensing_m(*state_.still));
  result.points = points_figures(state_.points_mm, state_.points_failed, state_.still);
  if (result.points) {
    result.points->controller = driver_.name;
    result.points->trial_s = config_.points.seconds;
  }
  judge(result, config_.needle.loop);
  return result;
}

}  // namespace lodestone::experiments
