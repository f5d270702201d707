#include "lodestone/experiments/suture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/log.h"
#include "lodestone/common/random.h"
#include "lodestone/control/learned_foresight.h"
#include "lodestone/control/rehearsal.h"
#include "lodestone/experiments/deployment.h"
#include "lodestone/experiments/heading_need.h"
#include "lodestone/experiments/routing.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::experiments {
namespace {

using geometry::Pose2;
using geometry::Stitch;
using geometry::Vector2;

constexpr double kMostOffTheWay_deg = 90.0;  // of a heading from the straight way between the ends

void check_stitch_point(const char* key, const std::vector<double>& point_mm) {
  if (point_mm.size() != 2) throw common::InvalidConfig(key, point_mm, "hold two numbers: x and y in mm");
}

Pose2 lying_at(const std::vector<double>& point_mm, double heading_deg) {
  return {point_mm.at(0) / geometry::kMmPerM, point_mm.at(1) / geometry::kMmPerM,
          geometry::wrap_angle(geometry::kRadPerDeg * heading_deg)};
}

std::string shown_lying(const Pose2& pose) {
  return fmt::format("({:.1f}, {:.1f}) mm at {:.0f} degrees", geometry::kMmPerM * pose.x_m,
                     geometry::kMmPerM * pose.y_m, geometry::kDegPerRad * pose.heading_rad);
}

/// What a stitch is called in messages.
std::string name_of_stitch(const SutureConfig& config, std::size_t index) {
  const char* const from = config.stitches.empty() ? "trials.suture" : "trials.suture.stitches";
  return fmt::format("{}: stitch {}", from, index + 1);
}

void check_stitch_ends(const Stitch& stitch, double radius_m, const std::string& name) {
  const Vector2 across_m = stitch.exit.position_m() - stitch.entry.position_m();
  if (!(across_m.norm() > 2.0 * radius_m))
    throw common::ConfigError(
        fmt::format("{}: entry and exit are {:.1f} mm apart, must be more than {:.1f} mm, within which one "
                    "place would count as both (twice score.stitch_radius_m)",
                    name, geometry::kMmPerM * across_m.norm(), 2.0 * geometry::kMmPerM * radius_m));
  const double across_rad = std::atan2(across_m.y(), across_m.x());
  for (const auto& [end, pose] : {std::pair("entry", stitch.entry), std::pair("exit", stitch.exit)}) {
    const double away_deg =
        geometry::kDegPerRad * std::abs(geometry::wrap_angle(pose.heading_rad - across_rad));
    if (away_deg > kMostOffTheWay_deg + 1e-6)
      throw common::ConfigError(
          fmt::format("{}: the heading of its {} is {:.0f} degrees off the way from entry to exit, must be "
                      "within {:.0f} of it, or the needle would go backwards; turn it, or swap the ends",
                      name, end, away_deg, kMostOffTheWay_deg));
  }
}

/// Lying along its way, the needle fits into the dish everywhere.
void check_way_fits(const geometry::Path& way, const physics::RigDescription& rig, const std::string& name) {
  constexpr double kStep_m = 0.0005;
  const auto steps = std::max(1, static_cast<int>(std::ceil(way.length_m() / kStep_m)));
  for (int i = 0; i <= steps; ++i) {
    const double at_m = way.length_m() * i / steps;
    const Vector2 point_m = way.at(at_m);
    const Pose2 lies{point_m.x(), point_m.y(), way.heading_rad(at_m).value()};
    if (!rig.fits(lies))
      throw common::ConfigError(
          fmt::format("{} leads the needle to {}, where it would reach beyond the wall of the dish: that has "
                      "a radius of {:.1f} mm; move the stitch, or shorten suture.approach_m or "
                      "suture.leave_m",
                      name, shown_lying(lies), geometry::kMmPerM * rig.dish.radius_m));
  }
}

}  // namespace

void StitchConfig::validate() const {
  check_stitch_point("entry_mm", entry_mm);
  check_stitch_point("exit_mm", exit_mm);
}

std::vector<Stitch> stitches_of(const SutureConfig& config) {
  if (config.stitches.empty()) return geometry::running_stitch(config.count, config.length_m, config.pitch_m);
  std::vector<Stitch> stitches;
  for (const StitchConfig& each : config.stitches)
    stitches.push_back({lying_at(each.entry_mm, each.entry_deg), lying_at(each.exit_mm, each.exit_deg)});
  return stitches;
}

control::SutureReferenceConfig suture_reference(const DeploymentConfig& config) {
  control::SutureReferenceConfig reference = config.suture;
  const auto held = [&reference](double within_m, double within_deg) {
    reference.arrive_m = std::max(reference.arrive_m, within_m);
    reference.arrive_deg = std::max(reference.arrive_deg, within_deg);
  };
  if (config.decorators.hold_radius_m > 0.0)
    held(config.decorators.hold_radius_m, config.decorators.hold_heading_deg);
  if (config.turn.current_A > 0.0) held(config.turn.leave_m, config.turn.heading_deg);
  return reference;
}

namespace {

/// Throws ConfigError, naming the stitch.
void check_ways(const DeploymentConfig& config, const std::vector<Stitch>& stitches) {
  const SutureConfig& suture = config.trials.suture;
  const geometry::KeepOut keep_out = config.safety.keeps_out(config.rig);
  std::optional<Vector2> left_m;  // the stitch before, behind it
  for (std::size_t i = 0; i < stitches.size(); ++i) {
    const std::string name = name_of_stitch(suture, i);
    check_stitch_ends(stitches[i], config.score.stitch_radius_m, name);
    const geometry::Path way =
        geometry::way_through(stitches[i], config.suture.approach_m, config.suture.leave_m);
    check_way_fits(way, config.rig, name);
    const std::vector<Vector2>& points_m = way.points_m();
    check_keeps_out(keep_out, left_m.value_or(points_m.front()), points_m.front(), name);
    for (std::size_t point = 1; point < points_m.size(); ++point)
      check_keeps_out(keep_out, points_m[point - 1], points_m[point], name);
    left_m = points_m.back();
  }
}

/// How far beside its ends each stitch is aimed at, for people.
std::string shown_aims(const std::vector<Stitch>& stitches, const std::vector<Stitch>& aims) {
  std::string text;
  for (std::size_t i = 0; i < stitches.size(); ++i) {
    const auto beside_mm = [](const Pose2& end, const Pose2& aim) {
      const Vector2 left(-std::sin(end.heading_rad), std::cos(end.heading_rad));
      return geometry::kMmPerM * left.dot(aim.position_m() - end.position_m());
    };
    text +=
        fmt::format("{}{:+.2f} and {:+.2f}", i == 0 ? "" : "; ", beside_mm(stitches[i].entry, aims[i].entry),
                    beside_mm(stitches[i].exit, aims[i].exit));
  }
  return text;
}

}  // namespace

void check_stitches(const DeploymentConfig& config) {
  refuse_heading(config.rig, "suture");
  check_ways(config, stitches_of(config.trials.suture));
}

std::vector<Stitch> aims_of(const DeploymentConfig& config, const ControllerSource& source,
                            const std::vector<Stitch>& stitches) {
  if (!source.rehearses_in || !source.make || config.suture.rehearsals == 0) return stitches;
  common::log_info(fmt::format("rehearsing {} stitches {} times each in the learned simulator",
                               stitches.size(), config.suture.rehearsals));
  const auto seed = common::derive_seed(static_cast<std::uint64_t>(config.seed), "rehearsal");
  const std::unique_ptr<control::Controller> controller = source.make(seed);
  control::LearnedForesight foresight(source.rehearses_in->simulator);
  const std::vector<Stitch> aims = control::rehearsed(
      stitches, suture_reference(config),
      {*controller, source.action, foresight, source.rehearses_in->drive_per_A(), config.loop.period_s()},
      seed);
  common::log_info(fmt::format("aimed at {} mm to the left of entries and exits (suture.aside_m: at most {})",
                               shown_aims(stitches, aims), geometry::kMmPerM * config.suture.aside_m));
  try {
    check_ways(config, aims);
  } catch (const common::ConfigError& error) {
    common::log_warning(
        fmt::format("all stitches are aimed at as they are, as there is no room beside them (a smaller "
                    "suture.aside_m may find some): {}",
                    error.what()));
    return stitches;
  }
  return aims;
}

}  // namespace lodestone::experiments
