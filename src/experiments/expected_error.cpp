#include "lodestone/experiments/expected_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "lodestone/common/random.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::experiments {
namespace {

constexpr double kGivenUp_mm = 5.0;
constexpr double kBeginsAt_mm = 10.0;  // the last part of the way is what counts
constexpr double kHopeless = 0.9;      // of the growth of scatter beyond which no step brings it closer
constexpr int kTrials = 800;
constexpr int kRedrawn = 200;  // times, for the interval

double squared_scatter_mm2(const ErrorSources& sources, const ErrorModel& model, double step_mm) {
  const StepLaw& law = sources.steps;
  return model.aim * model.aim * (law.floor_mm * law.floor_mm + law.growth * law.growth * step_mm * step_mm);
}

geometry::Vector2 normal_mm(double sigma_mm, common::RandomStream& random) {
  const double x = random.normal();
  const double y = random.normal();
  return sigma_mm * geometry::Vector2(x, y);
}

/// Where the needle lies at the end of one trial, from its target.
double played_mm(const ErrorSources& sources, const ErrorModel& model, double rest_mm,
                 common::RandomStream& random) {
  geometry::Vector2 at_mm(kBeginsAt_mm, 0.0);
  geometry::Vector2 error_mm = normal_mm(sources.sensing_mm, random);
  for (std::int64_t pulse = 0; pulse < sources.pulses; ++pulse) {
    if (random.uniform() < sources.refused) continue;
    const geometry::Vector2 seen_mm = at_mm + error_mm;
    const double distance_mm = seen_mm.norm();
    if (distance_mm <= rest_mm) break;
    const double step_mm = std::max(distance_mm, sources.steps.smallest_step_mm);
    at_mm -= seen_mm * (step_mm / distance_mm);
    at_mm += normal_mm(std::sqrt(squared_scatter_mm2(sources, model, step_mm)), random);
    error_mm = normal_mm(sources.sensing_mm, random);
  }
  return at_mm.norm();
}

/// As many pulses of each level as there are, each drawn from them.
std::vector<WeakPulse> drawn_anew(const std::map<std::size_t, std::vector<WeakPulse>>& levels,
                                  common::RandomStream& random) {
  std::vector<WeakPulse> drawn;
  for (const auto& [level, pulses] : levels)
    for (std::size_t i = 0; i < pulses.size(); ++i) drawn.push_back(pulses[random.below(pulses.size())]);
  return drawn;
}

}  // namespace

double rest_distance_mm(const ErrorSources& sources, const ErrorModel& model) {
  constexpr double kHalfPi = 0.5 * geometry::kPi;
  const double sensed_mm2 = 2.0 * sources.sensing_mm * sources.sensing_mm;
  const double smallest_mm = sources.steps.smallest_step_mm;
  const double spread_mm2 = squared_scatter_mm2(sources, model, smallest_mm) + sensed_mm2;
  double rest_mm = kGivenUp_mm;
  if (kHalfPi * spread_mm2 <= smallest_mm * smallest_mm && smallest_mm > 0.0) {
    rest_mm = 0.5 * smallest_mm + 0.5 * kHalfPi * spread_mm2 / smallest_mm;
  } else {
    const double growing = kHalfPi * std::pow(model.aim * sources.steps.growth, 2);
    const double floor_mm2 = squared_scatter_mm2(sources, model, 0.0) + sensed_mm2;
    if (growing < kHopeless) rest_mm = std::sqrt(kHalfPi * floor_mm2 / (1.0 - growing));
  }
  return std::min(kGivenUp_mm, model.patience * rest_mm);
}

PointErrors point_errors(const ErrorSources& sources, const ErrorModel& model) {
  PointErrors errors;
  errors.rest_mm = rest_distance_mm(sources, model);
  std::vector<double> ends_mm;
  for (int trial = 0; trial < kTrials; ++trial) {
    common::RandomStream random(1, "qualify/expected error", static_cast<std::uint64_t>(trial));
    ends_mm.push_back(played_mm(sources, model, errors.rest_mm, random));
  }
  errors.rms_mm = common::root_mean_square(ends_mm);
  errors.p95_mm = common::percentile(ends_mm, 0.95);
  return errors;
}

std::optional<runs::ExpectedErrorFigures> expected_error(const std::vector<WeakPulse>& pulses,
                                                         double sensing_m, double refused,
                                                         std::int64_t trial_pulses) {
  const std::optional<StepLaw> law = step_law(step_levels(pulses, sensing_m));
  if (!law) return std::nullopt;
  ErrorSources sources;
  sources.sensing_mm = geometry::kMmPerM * sensing_m;
  sources.steps = *law;
  sources.refused = refused;
  sources.pulses = trial_pulses;
  const PointErrors errors = point_errors(sources);
  runs::ExpectedErrorFigures figures;
  figures.rest_mm = errors.rest_mm;
  figures.sensing_mm = sources.sensing_mm;
  figures.smallest_step_mm = law->smallest_step_mm;
  figures.scatter_floor_mm = law->floor_mm;
  figures.scatter_growth = law->growth;
  ErrorSources perfect = sources;
  perfect.sensing_mm = 0.0;
  if (errors.rms_mm > 0.0)
    figures.by_sensing =
        std::clamp(1.0 - std::pow(point_errors(perfect).rms_mm / errors.rms_mm, 2), 0.0, 1.0);

  std::map<std::size_t, std::vector<WeakPulse>> levels;
  for (const WeakPulse& pulse : pulses) levels[pulse.level].push_back(pulse);
  common::RandomStream random(1, "qualify/weak pulses");
  std::vector<double> rms_mm, p95_mm;
  for (int i = 0; i < kRedrawn; ++i) {
    const std::optional<StepLaw> other = step_law(step_levels(drawn_anew(levels, random), sensing_m));
    if (!other) continue;
    sources.steps = *other;
    const PointErrors redrawn = point_errors(sources);
    rms_mm.push_back(redrawn.rms_mm);
    p95_mm.push_back(redrawn.p95_mm);
  }
  const auto with_interval = [&](double value, const std::vector<double>& values) {
    runs::Measured figure;
    figure.value = value;
    figure.n = static_cast<std::int64_t>(pulses.size());
    if (!values.empty())
      figure.interval =
          std::array<double, 2>{common::percentile(values, 0.025), common::percentile(values, 0.975)};
    return figure;
  };
  figures.rms_mm = with_interval(errors.rms_mm, rms_mm);
  figures.p95_mm = with_interval(errors.p95_mm, p95_mm);
  return figures;
}

}  // namespace lodestone::experiments
