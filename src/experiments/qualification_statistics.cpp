#include "lodestone/experiments/qualification_statistics.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "lodestone/common/statistics.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::experiments {
namespace {

constexpr std::size_t kFewestLooks = 10;
constexpr std::size_t kFewestPulses = 3;     // of which anything is said
constexpr std::size_t kFewestExplained = 7;  // from whose starts something can be told
constexpr std::size_t kFewestSamples = 6;    // of a current that rises
constexpr double kNoCurrent = 0.05;          // of what was asked for
constexpr double kSpreadsSeen = 5.0;         // that a look differs by is motion,
constexpr double kSpreadsReported = 4.0;     // and of the spread that is reported

/// Change of values per time, by least squares, and its standard error.
struct Trend {
  double per_s = 0.0;
  double error_per_s = 0.0;
};

Trend trend_of(const std::vector<double>& times_s, const std::vector<double>& values) {
  const double middle_s = common::mean(times_s);
  const double middle = common::mean(values);
  double squares = 0.0;
  double products = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    squares += (times_s[i] - middle_s) * (times_s[i] - middle_s);
    products += (times_s[i] - middle_s) * (values[i] - middle);
  }
  Trend trend;
  if (squares <= 0.0) return trend;
  trend.per_s = products / squares;
  double left = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i)
    left += std::pow(values[i] - middle - trend.per_s * (times_s[i] - middle_s), 2);
  trend.error_per_s = std::sqrt(left / static_cast<double>(values.size() - 2) / squares);
  return trend;
}

runs::Measured drift_of(const std::vector<double>& times_s, const std::vector<double>& x_mm,
                        const std::vector<double>& y_mm) {
  constexpr double kPerMinute = 60.0;
  const Trend x = trend_of(times_s, x_mm);
  const Trend y = trend_of(times_s, y_mm);
  runs::Measured drift;
  drift.n = static_cast<std::int64_t>(times_s.size());
  drift.value = kPerMinute * std::hypot(x.per_s, y.per_s);
  const double half = 1.96 * kPerMinute * std::hypot(x.error_per_s, y.error_per_s);
  drift.interval = std::array<double, 2>{std::max(0.0, drift.value - half), drift.value + half};
  return drift;
}

double root_of_mean(const std::vector<double>& squares) { return std::sqrt(common::mean(squares)); }

Eigen::MatrixXd steps_mm(const std::vector<PulseMotion>& pulses) {
  Eigen::MatrixXd steps(static_cast<Eigen::Index>(pulses.size()), 2);
  for (std::size_t i = 0; i < pulses.size(); ++i)
    steps.row(static_cast<Eigen::Index>(i)) = geometry::kMmPerM * pulses[i].step_m().transpose();
  return steps;
}

/// 1, and place and heading of the start beside those of the first pulse.
Eigen::MatrixXd starts_of(const std::vector<PulseMotion>& pulses) {
  Eigen::MatrixXd known(static_cast<Eigen::Index>(pulses.size()), 4);
  const geometry::Pose2& first = pulses.front().before;
  for (std::size_t i = 0; i < pulses.size(); ++i) {
    const geometry::Pose2& start = pulses[i].before;
    known.row(static_cast<Eigen::Index>(i)) << 1.0, geometry::kMmPerM * (start.x_m - first.x_m),
        geometry::kMmPerM * (start.y_m - first.y_m),
        geometry::wrap_angle(start.heading_rad - first.heading_rad);
  }
  return known;
}

/// Scatter with its interval: of the rows of what is left, each drawn anew.
runs::Measured scatter_of(const Explanation& explanation, const std::string& what) {
  std::vector<double> squares;
  for (Eigen::Index i = 0; i < explanation.left.rows(); ++i)
    squares.push_back(explanation.left.row(i).squaredNorm());
  const double inflation = static_cast<double>(squares.size()) /
                           (2.0 * static_cast<double>(std::max<std::int64_t>(1, explanation.freedom)));
  return measured(
      squares,
      [inflation](const std::vector<double>& drawn) { return std::sqrt(inflation * common::mean(drawn)); },
      what);
}

std::vector<double> lengths_mm(const std::vector<PulseMotion>& pulses) {
  std::vector<double> lengths;
  for (const PulseMotion& pulse : pulses) lengths.push_back(geometry::kMmPerM * pulse.step_m().norm());
  return lengths;
}

/// When the current has first come to so much of its end value.
double crossing_s(const std::vector<CurrentSample>& samples, double level_A) {
  const double sign = level_A < 0.0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (sign * samples[i].current_A < sign * level_A) continue;
    if (i == 0) return samples[0].after_s;
    const CurrentSample& below = samples[i - 1];
    const double part = (level_A - below.current_A) / (samples[i].current_A - below.current_A);
    return below.after_s + part * (samples[i].after_s - below.after_s);
  }
  return samples.back().after_s;
}

/// RMS of true distances behind one of sensed ones (points_figures).
double behind_sensed_mm(double sensed_mm, const runs::StillFigures& still) {
  const double scatter_mm2 = std::pow(still.x_mm.value, 2) + std::pow(still.y_mm.value, 2);
  const double reported_mm2 = 2.0 * std::pow(still.reported_mm.value_or(0.0), 2);
  return std::sqrt(std::max(0.0, sensed_mm * sensed_mm - scatter_mm2) +
                   std::max(0.0, reported_mm2 - scatter_mm2));
}

std::array<double, 2> edges(const common::Interval& interval) { return {interval.low, interval.high}; }

}  // namespace

runs::Measured measured(const std::vector<double>& values,
                        const std::function<double(const std::vector<double>&)>& statistic,
                        const std::string& what) {
  runs::Measured result;
  result.n = static_cast<std::int64_t>(values.size());
  result.value = statistic(values);
  if (values.size() < kFewestPulses) return result;
  const common::Interval interval =
      common::bootstrap_interval({values}, statistic, common::RandomStream(1, "qualify/" + what));
  result.interval = std::array<double, 2>{interval.low, interval.high};
  return result;
}

std::optional<runs::StillFigures> still_figures(const std::vector<StillLook>& looks, std::int64_t refused) {
  if (looks.size() < kFewestLooks) return std::nullopt;
  std::vector<double> x_mm, y_mm, heading_deg, times_s;
  for (const StillLook& look : looks) {
    x_mm.push_back(geometry::kMmPerM * look.pose.x_m);
    y_mm.push_back(geometry::kMmPerM * look.pose.y_m);
    heading_deg.push_back(geometry::kDegPerRad *
                          geometry::wrap_angle(look.pose.heading_rad - looks.front().pose.heading_rad));
    times_s.push_back(look.time_s);
  }
  runs::StillFigures figures;
  figures.refused = refused;
  figures.x_mm = measured(x_mm, common::standard_deviation, "x");
  figures.y_mm = measured(y_mm, common::standard_deviation, "y");
  figures.heading_deg = measured(heading_deg, common::standard_deviation, "heading");
  figures.drift_mm_per_min = drift_of(times_s, x_mm, y_mm);
  const Eigen::Vector2d middle_mm(common::mean(x_mm), common::mean(y_mm));
  const double middle_deg = common::mean(heading_deg);
  std::vector<double> place, turn, reported_mm2, reported_deg2;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const Eigen::Matrix2d covariance_mm2 =
        geometry::kMmPerM * geometry::kMmPerM * looks[i].position_covariance_m2;
    const double sigma_deg = geometry::kDegPerRad * looks[i].heading_sigma_rad;
    const Eigen::Vector2d off_mm = Eigen::Vector2d(x_mm[i], y_mm[i]) - middle_mm;
    if (covariance_mm2.determinant() > 0.0) {
      place.push_back(0.5 * off_mm.dot(covariance_mm2.inverse() * off_mm));
      reported_mm2.push_back(0.5 * covariance_mm2.trace());
    }
    if (sigma_deg > 0.0) {
      turn.push_back(std::pow((heading_deg[i] - middle_deg) / sigma_deg, 2));
      reported_deg2.push_back(sigma_deg * sigma_deg);
    }
  }
  if (!place.empty()) {
    figures.whitened_position = measured(place, root_of_mean, "whitened position");
    figures.reported_mm = root_of_mean(reported_mm2);
  }
  if (!turn.empty()) {
    figures.whitened_heading = measured(turn, root_of_mean, "whitened heading");
    figures.reported_deg = root_of_mean(reported_deg2);
  }
  return figures;
}

double sensing_m(const runs::StillFigures& still) {
  const double seen_mm = std::sqrt(0.5) * std::hypot(still.x_mm.value, still.y_mm.value);
  return std::max(seen_mm, still.reported_mm.value_or(0.0)) / geometry::kMmPerM;
}

bool MotionThreshold::moved(const geometry::Pose2& before, const geometry::Pose2& after) const {
  return (after.position_m() - before.position_m()).norm() >= distance_m ||
         std::abs(geometry::wrap_angle(after.heading_rad - before.heading_rad)) >= turn_rad;
}

MotionThreshold motion_threshold(const runs::StillFigures& still) {
  MotionThreshold threshold;
  threshold.distance_m = std::max(
      {threshold.distance_m, kSpreadsSeen * std::max(still.x_mm.value, still.y_mm.value) / geometry::kMmPerM,
       kSpreadsReported * still.reported_mm.value_or(0.0) / geometry::kMmPerM});
  threshold.turn_rad =
      std::max({threshold.turn_rad, kSpreadsSeen * still.heading_deg.value * geometry::kRadPerDeg,
                kSpreadsReported * still.reported_deg.value_or(0.0) * geometry::kRadPerDeg});
  return threshold;
}

double Explanation::scatter() const {
  return std::sqrt(left.squaredNorm() / (2.0 * static_cast<double>(std::max<std::int64_t>(1, freedom))));
}

Explanation explain_steps(const Eigen::MatrixXd& known, const Eigen::MatrixXd& steps) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(known);
  const Eigen::MatrixXd weights = solver.solve(steps);
  Explanation explanation;
  explanation.fitted = known * weights;
  explanation.left = steps - explanation.fitted;
  explanation.freedom = static_cast<std::int64_t>(known.rows()) - static_cast<std::int64_t>(solver.rank());
  return explanation;
}

std::optional<runs::SamePulseFigures> same_pulse_figures(const std::vector<PulseMotion>& pulses) {
  if (pulses.size() < kFewestPulses) return std::nullopt;
  const Eigen::MatrixXd steps = steps_mm(pulses);
  const Explanation mean_only = explain_steps(Eigen::MatrixXd::Ones(steps.rows(), 1), steps);
  const Explanation by_start =
      pulses.size() < kFewestExplained ? mean_only : explain_steps(starts_of(pulses), steps);
  runs::SamePulseFigures figures;
  figures.step_mm = measured(lengths_mm(pulses), common::mean, "step");
  figures.all_mm = scatter_of(mean_only, "scatter of the same pulse");
  figures.scatter_mm = scatter_of(by_start, "scatter of the same pulse by its start");
  if (figures.all_mm.value > 0.0)
    figures.explained = std::max(0.0, 1.0 - std::pow(figures.scatter_mm.value / figures.all_mm.value, 2));
  figures.share_of_step = figures.scatter_mm;
  const double step_mm = figures.step_mm.value;
  if (step_mm <= 0.0) return std::nullopt;
  figures.share_of_step.value /= step_mm;
  if (figures.share_of_step.interval)
    for (double& edge : *figures.share_of_step.interval) edge /= step_mm;
  return figures;
}

std::optional<runs::Measured> step_change(const std::vector<PulseMotion>& first,
                                          const std::vector<PulseMotion>& second) {
  if (first.size() < kFewestPulses || second.size() < kFewestPulses) return std::nullopt;
  const std::vector<double> early_mm = lengths_mm(first);
  const std::vector<double> late_mm = lengths_mm(second);
  std::vector<double> all_mm = early_mm;
  all_mm.insert(all_mm.end(), late_mm.begin(), late_mm.end());
  const double middle_mm = common::mean(all_mm);
  if (middle_mm <= 0.0) return std::nullopt;
  const common::Interval interval =
      common::difference_interval(late_mm, early_mm, common::RandomStream(1, "qualify/step change"));
  runs::Measured change;
  change.n = static_cast<std::int64_t>(all_mm.size());
  change.value = (common::mean(late_mm) - common::mean(early_mm)) / middle_mm;
  change.interval = std::array<double, 2>{interval.low / middle_mm, interval.high / middle_mm};
  return change;
}

std::optional<CurrentRise> current_rise(const std::vector<CurrentSample>& samples, double asked_A) {
  if (samples.size() < kFewestSamples || asked_A == 0.0) return std::nullopt;
  std::vector<double> last_A;
  for (std::size_t i = samples.size() - samples.size() / 3; i < samples.size(); ++i)
    last_A.push_back(samples[i].current_A);
  const double end_A = common::median(last_A);
  if (std::abs(end_A) < kNoCurrent * std::abs(asked_A)) return std::nullopt;
  CurrentRise rise;
  rise.gain = end_A / asked_A;
  rise.rise_s = crossing_s(samples, 0.9 * end_A) - crossing_s(samples, 0.1 * end_A);
  rise.half_s = crossing_s(samples, 0.5 * end_A);
  return rise;
}

std::vector<runs::CoilFigures> coil_figures(const std::vector<std::string>& names,
                                            const std::vector<std::vector<CurrentRise>>& rises) {
  const auto of = [&rises](std::size_t coil, const auto& figure) {
    std::vector<double> values;
    for (const CurrentRise& rise : rises[coil]) values.push_back(figure(rise));
    return values;
  };
  const auto half_ms = [](const CurrentRise& rise) { return 1e3 * rise.half_s; };
  std::vector<double> halves_ms;
  for (std::size_t coil = 0; coil < names.size(); ++coil)
    if (!rises[coil].empty()) halves_ms.push_back(common::mean(of(coil, half_ms)));
  const double middle_ms = common::mean(halves_ms);
  std::vector<runs::CoilFigures> coils;
  for (std::size_t coil = 0; coil < names.size(); ++coil) {
    runs::CoilFigures& figures = coils.emplace_back();
    figures.name = names[coil];
    if (rises[coil].empty()) continue;
    figures.gain = measured(of(coil, [](const CurrentRise& rise) { return rise.gain; }), common::mean,
                            "gain " + names[coil]);
    figures.rise_ms = measured(of(coil, [](const CurrentRise& rise) { return 1e3 * rise.rise_s; }),
                               common::mean, "rise " + names[coil]);
    figures.skew_ms = measured(of(coil, [&](const CurrentRise& rise) { return half_ms(rise) - middle_ms; }),
                               common::mean, "skew " + names[coil]);
  }
  return coils;
}

std::optional<runs::LatencyFigures> latency_figures(const std::vector<double>& moved_s, double look_s,
                                                    std::int64_t unseen) {
  if (moved_s.size() < kFewestPulses) return std::nullopt;
  std::vector<double> began_ms;
  for (const double seen_s : moved_s) began_ms.push_back(1e3 * (seen_s - 0.5 * look_s));
  runs::LatencyFigures figures;
  figures.ms = measured(began_ms, common::mean, "latency");
  figures.resolution_ms = 1e3 * look_s;
  figures.unseen = unseen;
  return figures;
}

std::optional<runs::PointsFigures> points_figures(const std::vector<double>& sensed_mm, std::int64_t failed,
                                                  const std::optional<runs::StillFigures>& still) {
  const auto ended = static_cast<std::int64_t>(sensed_mm.size());
  const std::int64_t trials = ended + failed;
  if (trials == 0) return std::nullopt;
  runs::PointsFigures figures;
  figures.failed.value = static_cast<double>(failed) / static_cast<double>(trials);
  figures.failed.n = trials;
  figures.failed.interval = edges(common::wilson_interval(failed, trials));
  if (ended == 0) return figures;
  figures.sensed_rms_mm = measured(sensed_mm, common::root_mean_square, "points");
  runs::Measured& p95_mm = figures.sensed_p95_mm.emplace();
  p95_mm.value = common::percentile(sensed_mm, 0.95);
  p95_mm.n = ended;
  if (sensed_mm.size() >= kFewestPulses)
    p95_mm.interval = edges(common::percentile_interval(sensed_mm, 0.95));
  if (!still) return figures;
  runs::Measured& rms_mm = figures.rms_mm.emplace(*figures.sensed_rms_mm);
  rms_mm.value = behind_sensed_mm(rms_mm.value, *still);
  if (rms_mm.interval)
    for (double& edge : *rms_mm.interval) edge = behind_sensed_mm(edge, *still);
  return figures;
}

}  // namespace lodestone::experiments
