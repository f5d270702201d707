#include "lodestone/experiments/stick_slip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <utility>

#include "lodestone/common/statistics.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::experiments {
namespace {

constexpr std::size_t kFewestOfLevel = 6;
constexpr double kEveryOther = 0.5;
constexpr double kLeastScatter = 0.3;  // of what is seen is not the sensor's

using PulseTest = std::function<bool(const WeakPulse&)>;

std::vector<WeakPulse> those(const std::vector<WeakPulse>& pulses, const PulseTest& test) {
  std::vector<WeakPulse> chosen;
  std::copy_if(pulses.begin(), pulses.end(), std::back_inserter(chosen), test);
  return chosen;
}

std::map<std::size_t, std::vector<WeakPulse>> by_level(const std::vector<WeakPulse>& pulses) {
  std::map<std::size_t, std::vector<WeakPulse>> levels;
  for (const WeakPulse& pulse : pulses) levels[pulse.level].push_back(pulse);
  return levels;
}

double mean_current_A(const std::vector<WeakPulse>& pulses) {
  double sum_A = 0.0;
  for (const WeakPulse& pulse : pulses) sum_A += pulse.current_A;
  return sum_A / static_cast<double>(pulses.size());
}

std::int64_t moved_of(const std::vector<WeakPulse>& pulses) {
  return std::count_if(pulses.begin(), pulses.end(), [](const WeakPulse& pulse) { return pulse.moved; });
}

/// Steps along and across the drive, and what is known before: 1, and where the heading is from the drive.
Explanation explain_level(const std::vector<WeakPulse>& pulses) {
  const auto rows = static_cast<Eigen::Index>(pulses.size());
  Eigen::MatrixXd known(rows, 3);
  Eigen::MatrixXd steps(rows, 2);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const WeakPulse& pulse = pulses[static_cast<std::size_t>(row)];
    const double off_rad = pulse.motion.before.heading_rad - pulse.drive_rad;
    known.row(row) << 1.0, std::cos(off_rad), std::sin(off_rad);
    const geometry::Vector2 step_mm = geometry::kMmPerM * pulse.motion.step_m();
    const double cosine = std::cos(pulse.drive_rad);
    const double sine = std::sin(pulse.drive_rad);
    steps.row(row) << cosine * step_mm.x() + sine * step_mm.y(), cosine * step_mm.y() - sine * step_mm.x();
  }
  return explain_steps(known, steps);
}

runs::Measured over_places(const std::vector<double>& currents_A, bool spread) {
  if (!spread) return measured(currents_A, common::mean, "break-away");
  const auto relative = [](const std::vector<double>& values) {
    const double middle = common::mean(values);
    return middle > 0.0 ? common::standard_deviation(values) / middle : 0.0;
  };
  return measured(currents_A, relative, "spread of the break-away");
}

}  // namespace

std::optional<double> breakaway_A(const std::vector<WeakPulse>& pulses) {
  double last_A = 0.0;
  double last_share = 0.0;
  for (const auto& [level, of_level] : by_level(pulses)) {
    const double current_A = mean_current_A(of_level);
    const double share = static_cast<double>(moved_of(of_level)) / static_cast<double>(of_level.size());
    if (share >= kEveryOther) {
      if (last_A <= 0.0) return current_A;
      return last_A * std::pow(current_A / last_A, (kEveryOther - last_share) / (share - last_share));
    }
    last_A = current_A;
    last_share = share;
  }
  return std::nullopt;
}

std::vector<runs::StepLevel> step_levels(const std::vector<WeakPulse>& pulses, double sensing_m) {
  std::vector<runs::StepLevel> levels;
  for (const auto& [index, of_level] : by_level(pulses)) {
    if (of_level.size() < kFewestOfLevel) continue;
    const Explanation explanation = explain_level(of_level);
    runs::StepLevel level;
    level.current_A = mean_current_A(of_level);
    level.n = static_cast<std::int64_t>(of_level.size());
    level.moved = moved_of(of_level);
    level.step_mm = explanation.fitted.rowwise().norm().mean();
    const double seen_mm = explanation.scatter();
    // Two looks lie between a start and an end.
    const double sensor_mm2 = 2.0 * std::pow(geometry::kMmPerM * sensing_m, 2);
    level.scatter_mm =
        std::max(kLeastScatter * seen_mm, std::sqrt(std::max(0.0, seen_mm * seen_mm - sensor_mm2)));
    levels.push_back(level);
  }
  return levels;
}

std::optional<runs::StickSlipFigures> stick_slip_figures(const std::vector<WeakPulse>& pulses,
                                                         double sensing_m) {
  if (pulses.empty()) return std::nullopt;
  runs::StickSlipFigures figures;
  std::size_t last_place = 0;
  for (const WeakPulse& pulse : pulses) last_place = std::max(last_place, pulse.place);
  std::vector<double> currents_A;
  for (std::size_t index = 0; index <= last_place; ++index) {
    const std::vector<WeakPulse> here =
        those(pulses, [index](const WeakPulse& pulse) { return pulse.place == index; });
    if (here.empty()) continue;
    runs::BreakawayPlace place;
    geometry::Vector2 sum_m = geometry::Vector2::Zero();
    for (const WeakPulse& pulse : here) {
      sum_m += pulse.motion.before.position_m();
      place.tried_up_to_A = std::max(place.tried_up_to_A, pulse.current_A);
    }
    place.pulses = static_cast<std::int64_t>(here.size());
    place.x_mm = geometry::kMmPerM * sum_m.x() / static_cast<double>(here.size());
    place.y_mm = geometry::kMmPerM * sum_m.y() / static_cast<double>(here.size());
    place.current_A = breakaway_A(here);
    if (place.current_A) currents_A.push_back(*place.current_A);
    figures.places.push_back(place);
  }
  if (!currents_A.empty()) figures.current_A = over_places(currents_A, false);
  if (currents_A.size() >= 3) figures.spread = over_places(currents_A, true);
  figures.levels = step_levels(pulses, sensing_m);
  return figures;
}

std::vector<std::optional<runs::Measured>> gains_by_motion(const std::vector<WeakPulse>& pulses,
                                                           std::size_t place, std::size_t coils) {
  std::vector<std::optional<double>> currents_A(coils);
  std::vector<std::size_t> counts(coils, 0);
  std::vector<double> found;
  for (std::size_t coil = 0; coil < coils; ++coil) {
    const std::vector<WeakPulse> its = those(
        pulses, [place, coil](const WeakPulse& pulse) { return pulse.place == place && pulse.coil == coil; });
    counts[coil] = its.size();
    currents_A[coil] = breakaway_A(its);
    if (currents_A[coil]) found.push_back(1.0 / *currents_A[coil]);
  }
  std::vector<std::optional<runs::Measured>> gains(coils);
  if (found.size() < 2) return gains;
  for (std::size_t coil = 0; coil < coils; ++coil) {
    if (!currents_A[coil]) continue;
    runs::Measured gain;
    gain.n = static_cast<std::int64_t>(counts[coil]);
    gain.value = 1.0 / *currents_A[coil] / common::mean(found);
    gains[coil] = gain;
  }
  return gains;
}

}  // namespace lodestone::experiments
