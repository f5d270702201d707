#include "lodestone/experiments/qualification.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/common/statistics.h"
#include "lodestone/experiments/qualification_verdict.h"
#include "lodestone/task/task.h"

namespace lodestone::experiments {
namespace {

// Of all the time, up to where each item may go on; it ends before where it has all that it wants.
constexpr double kStillUntil = 0.04, kCoilsUntil = 0.14, kEarlyUntil = 0.26, kLatencyUntil = 0.34,
                 kWeakUntil = 0.66, kRoamUntil = 0.83, kLateUntil = 0.95, kAllUntil = 1.0;

constexpr std::size_t kStillLooks = 300;
constexpr int kRounds = 5;  // of pulses through every coil
constexpr double kCurrentPulse_s = 0.2;
constexpr double kPoll_s = 2e-3;         // between reports of a current
constexpr std::size_t kSamePulses = 10;  // at the beginning, and at the end
constexpr int kLatencyPulses = 20;
constexpr double kMotionWithin_s = 0.6;   // of a pulse
constexpr int kVisits = 80;               // while it roams
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
constexpr double kFarEnough_m = 1e-3;  // that all pulses of two levels move the needle on average

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

std::unique_ptr<session::RigSession> make_qualification_session(const QualificationConfig& config) {
  const auto seed = static_cast<std::uint64_t>(config.seed);
  session::VirtualSeeds seeds;
  seeds.rig = static_cast<std::uint64_t>(config.rig_seed);
  seeds.scene = static_cast<std::uint64_t>(config.sensor_seed);
  seeds.sensor_noise = common::RandomStream(seed, "qualify/sensor noise");
  seeds.scatter = common::RandomStream(seed, "qualify/scatter");
  return session::make_virtual_session(config.rig, config.sensor, config.safety, seeds);
}

Qualification::Qualification(const QualificationConfig& config, session::RigSession& bench, Watch watch)
    : config_(config),
      bench_(bench),
      watch_(std::move(watch)),
      needle_(config.needle, config.rig, bench),
      pull_(config.rig),
      start_s_(bench.clock().now_s()),
      rises_(config.rig.coils.count()) {}

runs::QualificationResult Qualification::run() {
  try {
    measure();
  } catch (const common::Error& error) {
    result_.stopped = error.what();
  } catch (...) {
    bench_.coils().stop();
    throw;
  }
  bench_.coils().stop();
  result_.minutes = (bench_.clock().now_s() - start_s_) / 60.0;
  close();
  return std::move(result_);
}

void Qualification::measure() {
  if (!needle_.here()) needle_.bring_to(geometry::Vector2::Zero(), kAbout_m);  // looks for it
  lie_still("still needle", kStillUntil, result_.still);
  if (result_.still) threshold_ = motion_threshold(*result_.still);
  note_temperatures(first_C_);
  measure_coils(kCoilsUntil);
  repeat_pulse("same pulse", early_, kEarlyUntil);
  measure_latency(kLatencyUntil);
  push_weakly(kWeakUntil);
  roam(kRoamUntil);
  repeat_pulse("same pulse again", late_, kLateUntil);
  lie_still("still needle again", kAllUntil, result_.still_at_end);
  note_temperatures(last_C_);
}

bool Qualification::time_for(const std::string& item, double share) {
  const double passed_s = bench_.clock().now_s() - start_s_;
  if (watch_) watch_(passed_s, item);
  return passed_s < share * 60.0 * config_.minutes;
}

void Qualification::lie_still(const std::string& item, double share,
                              std::optional<runs::StillFigures>& figures) {
  std::vector<StillLook> looks;
  std::int64_t refused = 0;
  while (looks.size() < kStillLooks && time_for(item, share)) {
    const control::PoseEstimate seen = needle_.fresh_look();
    if (!seen.valid) {
      ++refused;
      continue;
    }
    looks.push_back({seen.pose, seen.position_covariance_m2, seen.heading_sigma_rad, seen.stamp_s});
  }
  figures = still_figures(looks, refused);
}

void Qualification::note_temperatures(std::vector<double>& temperatures_C) {
  temperatures_C = bench_.coils().status().temperature_C.list();
}

double Qualification::test_current_of(std::size_t coil) const {
  return std::min({config_.test_current_A, config_.rig.coils.largest_A(coil), config_.safety.max_current_A});
}

void Qualification::keep_inside() {
  const std::optional<geometry::Pose2> here = needle_.here();
  if (!here || here->position_m().norm() > kInside * config_.rig.dish.radius_m)
    needle_.bring_to(geometry::Vector2::Zero(), kAbout_m);
}

void Qualification::measure_coils(double share) {
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t coil = 0; coil < rises_.size(); ++coil) {
      if (!time_for("coils", share)) return;
      keep_inside();
      if (needle_.here()) measure_coil(coil);
    }
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
  reports_ += static_cast<std::int64_t>(samples.size());
  if (const auto rise = current_rise(samples, pulse.current_A[coil])) rises_[coil].push_back(*rise);
}

void Qualification::repeat_pulse(const std::string& item, std::vector<PulseMotion>& pulses, double share) {
  const geometry::Vector2 start_m(kStartAt * config_.rig.dish.radius_m, 0.0);
  const double most_A = std::min(config_.rig.coils.max_current_A, config_.safety.max_current_A);
  geometry::Drive drive_A = pull_.drive_A({config_.rig.breakaway_N(), 0.0}, start_m);
  if (drive_A.isZero(0.0))
    drive_A = physics::CoilDrive(config_.rig).along({config_.test_current_A, 0.0}, start_m);
  drive_A *= std::min(1.0, most_A / drive_A.cwiseAbs().maxCoeff());
  const geometry::Vector2 across_A(0.0, std::min(kAlignedBy_A, most_A));
  for (std::size_t i = 0; i < 2 * kSamePulses && pulses.size() < kSamePulses && time_for(item, share); ++i) {
    if (!needle_.bring_to(start_m, kAlike_m)) continue;
    if (!needle_.push_along(across_A) || !needle_.push_along(across_A)) continue;
    if (const std::optional<PulseMotion> motion = needle_.push(drive_A)) pulses.push_back(*motion);
  }
}

void Qualification::measure_latency(double share) {
  for (int i = 0; i < kLatencyPulses && time_for("latency", share); ++i) {
    keep_inside();
    if (!needle_.here()) continue;
    const double phase = kGoldenPart * i;
    if (!time_motion(phase - std::floor(phase))) ++unseen_;
    needle_.rest();
  }
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
  const double current_A =
      std::min({config_.test_current_A, config_.rig.coils.max_current_A, config_.safety.max_current_A});
  const rig::CoilPulse pulse =
      needle_.pulse_along(current_A * geometry::Vector2(drive.x, drive.y), before->position_m());
  common::Clock& clock = bench_.clock();
  clock.sleep_until(clock.now_s() + part * config_.needle.look_s);
  const double start_s = clock.now_s();
  needle_.pulse(pulse);
  while (clock.now_s() < start_s + kMotionWithin_s) {
    const control::PoseEstimate seen = needle_.look_during(pulse);
    if (!seen.valid || seen.stamp_s < start_s || !threshold_.moved(*before, seen.pose)) continue;
    moved_s_.push_back(seen.stamp_s - start_s);
    gaps_s_.push_back(needle_.look_during(pulse).stamp_s - seen.stamp_s);
    return true;
  }
  return false;
}

void Qualification::push_weakly(double share) {
  const std::vector<geometry::Vector2> places_m = weak_places_m(config_.rig.dish.radius_m);
  for (std::size_t place = 0; place < places_m.size() && time_for("weak pulses", share); ++place)
    if (needle_.bring_to(places_m[place], kAbout_m)) climb(place, places_m[place], share);
}

void Qualification::climb(std::size_t place, const geometry::Vector2& at_m, double share) {
  const bool pairs = config_.rig.drive.kind == physics::DriveKind::kOpposedPairs;
  const double most_A = std::min(config_.rig.coils.max_current_A, config_.safety.max_current_A);
  const geometry::Vector2 inwards =
      at_m.isZero(0.0) ? geometry::Vector2(1.0, 0.0) : geometry::Vector2(-at_m.normalized());
  const geometry::Drive described_A = pull_.drive_A(config_.rig.breakaway_N() * inwards, at_m);
  double current_A = kWeakest * (described_A.isZero(0.0) ? most_A : described_A.cwiseAbs().maxCoeff());
  int far_levels = 0;
  for (std::size_t level = 0; current_A <= most_A && far_levels < 2; ++level, current_A *= kStronger) {
    int pulses = 0, moved = 0;
    double way_m = 0.0;
    for (int i = 0; i < kPulsesOfLevel; ++i) {
      if (!time_for("weak pulses", share)) return;
      const std::optional<geometry::Pose2> here = needle_.here();
      if (!here || here->position_m().norm() > kTooFar * config_.rig.dish.radius_m)
        needle_.bring_to(at_m, kAbout_m);
      const AxisDrive& axis = kAxisDrives[static_cast<std::size_t>(i) % kAxisDrives.size()];
      const std::optional<PulseMotion> motion =
          needle_.push_along(current_A * geometry::Vector2(axis.x, axis.y));
      if (!motion) continue;
      WeakPulse weak;
      weak.place = place;
      weak.level = level;
      weak.current_A = current_A;
      if (pairs) weak.coil = axis.coil;
      weak.drive_rad = std::atan2(axis.y, axis.x);
      weak.motion = *motion;
      weak.moved = threshold_.moved(motion->before, motion->after);
      weak_.push_back(weak);
      ++pulses;
      moved += weak.moved ? 1 : 0;
      way_m += motion->step_m().norm();
    }
    const bool far = pulses > 0 && moved == pulses && way_m >= kFarEnough_m * pulses;
    far_levels = far ? far_levels + 1 : 0;
  }
}

void Qualification::roam(double share) {
  common::RandomStream random(static_cast<std::uint64_t>(config_.seed), "qualify/places");
  for (int visit = 0; visit < kVisits && time_for("refusals", share); ++visit)
    needle_.bring_to(task::draw_in_disc(kRoam * config_.rig.dish.radius_m, random), kAbout_m);
}

void Qualification::close() {
  const physics::CoilsDescription& coils = config_.rig.coils;
  result_.dish_radius_mm = geometry::kMmPerM * config_.rig.dish.radius_m;
  const runs::RefusalFigures refusals = needle_.refusals().figures();
  if (refusals.share.n > 0) result_.refusals = refusals;
  result_.latency = latency_figures(moved_s_, common::median(gaps_s_), unseen_);
  std::vector<PulseMotion> pulses = early_;
  pulses.insert(pulses.end(), late_.begin(), late_.end());
  result_.same_pulse = same_pulse_figures(pulses);
  result_.step_change = step_change(early_, late_);
  std::vector<std::string> names;
  for (std::size_t coil = 0; coil < coils.count(); ++coil) names.push_back(coils.name(coil));
  result_.coils = coil_figures(names, rises_);
  const auto by_motion = gains_by_motion(weak_, 0, coils.count());
  for (std::size_t coil = 0; coil < coils.count(); ++coil) {
    runs::CoilFigures& figures = result_.coils[coil];
    figures.gain_by_motion = by_motion[coil];
    if (coil < first_C_.size()) figures.first_C = first_C_[coil];
    if (coil < last_C_.size()) figures.last_C = last_C_[coil];
    if (!figures.gain)
      figures.why = reports_ == 0 ? "currents: not measured, as the coils report none while they are on"
                                  : "currents: not measured, as none was seen to rise in this coil";
    if (!figures.gain_by_motion)
      figures.why += std::string(figures.why.empty() ? "" : "; ") +
                     (config_.rig.drive.kind == physics::DriveKind::kOpposedPairs
                          ? "gain by motion: not measured, as no weak pulse of this coil moved the needle"
                          : "gain by motion: not measured, as drives of this rig share several coils");
  }
  if (result_.still) result_.stick_slip = stick_slip_figures(weak_, sensing_m(*result_.still));
  judge(result_, config_.needle.loop);
}

}  // namespace lodestone::experiments
