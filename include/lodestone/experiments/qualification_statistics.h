#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/geometry/pose2.h"
#include "lodestone/runs/qualification_result.h"

namespace lodestone::experiments {

/// A statistic of values, with its interval by bootstrap from three values on. `what` names the random
/// stream.
runs::Measured measured(const std::vector<double>& values,
                        const std::function<double(const std::vector<double>&)>& statistic,
                        const std::string& what);

/// A look at a needle that lies still, with the spread that the sensor reports of it (0: none).
struct StillLook {
  geometry::Pose2 pose;
  Eigen::Matrix2d position_covariance_m2 = Eigen::Matrix2d::Zero();
  double heading_sigma_rad = 0.0;
  double time_s = 0.0;
};
/// Nothing of fewer than ten looks.
std::optional<runs::StillFigures> still_figures(const std::vector<StillLook>& looks, std::int64_t refused);

/// Spread of a sensed position, m, per axis, of a needle that may lie anywhere: what is reported, which holds
/// from place to place, or what was seen where that is more.
double sensing_m(const runs::StillFigures& still);

/// What counts as motion between two looks: beyond what a sensor that errs so makes of a needle that lies
/// still.
struct MotionThreshold {
  double distance_m = 0.1e-3;
  double turn_rad = 0.5 * geometry::kRadPerDeg;

  bool moved(const geometry::Pose2& before, const geometry::Pose2& after) const;
};
MotionThreshold motion_threshold(const runs::StillFigures& still);

/// What one pulse did.
struct PulseMotion {
  geometry::Pose2 before, after;

  geometry::Vector2 step_m() const { return after.position_m() - before.position_m(); }
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("before_x_m", before.x_m);
    v.field("before_y_m", before.y_m);
    v.field("before_heading_rad", before.heading_rad);
    v.field("after_x_m", after.x_m);
    v.field("after_y_m", after.y_m);
    v.field("after_heading_rad", after.heading_rad);
  }
};

/// Displacements [n, 2] by least squares from what is known before [n, k].
struct Explanation {
  Eigen::MatrixXd fitted, left;
  std::int64_t freedom = 0;  ///< rows less the rank of what is known

  /// Per axis.
  double scatter() const;
};
Explanation explain_steps(const Eigen::MatrixXd& known, const Eigen::MatrixXd& steps);

/// Of at least three pulses; the starts' part (linear in place and heading) is told apart from seven on.
std::optional<runs::SamePulseFigures> same_pulse_figures(const std::vector<PulseMotion>& pulses);
/// How much further the pulses of the second list go, by the mean of all. At least three of each.
std::optional<runs::Measured> step_change(const std::vector<PulseMotion>& first,
                                          const std::vector<PulseMotion>& second);

/// A current that a coil reported so long after its pulse was asked for.
struct CurrentSample {
  double after_s = 0.0;
  double current_A = 0.0;
};
struct CurrentRise {
  double gain = 0.0;    ///< end value by what was asked for
  double rise_s = 0.0;  ///< from 10 to 90 % of the end value
  double half_s = 0.0;  ///< until half of it

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("gain", gain);
    v.field("rise_s", rise_s);
    v.field("half_s", half_s);
  }
};
/// Nothing where fewer than six samples were taken, or no current rose. Samples are in order of time, of the
/// pulse alone; the end value is the median of their last third.
std::optional<CurrentRise> current_rise(const std::vector<CurrentSample>& samples, double asked_A);
/// Coils by their pulses; skews are against the mean of the coils that were measured.
std::vector<runs::CoilFigures> coil_figures(const std::vector<std::string>& names,
                                            const std::vector<std::vector<CurrentRise>>& rises);

/// `moved_s`: how long after a pulse was asked for the first look with motion came. Looks come every
/// `look_s`, and at another phase after every pulse, so that motion began half of that before, on average.
/// Nothing of fewer than three.
std::optional<runs::LatencyFigures> latency_figures(const std::vector<double>& moved_s, double look_s,
                                                    std::int64_t unseen);

/// Trials to points: `sensed_mm`, the sensed distances to the target at their ends, of those that went to
/// their end, and how many were stopped early (`failed`). Controller and length of a trial stay empty.
/// Nothing without trials.
///
/// A sensed distance has the scatter from look to look in it, which a true one has not; and it does not show
/// what the sensor errs by at a place in every look there, as the needle was driven to where it is sensed to
/// be at the target. So
///   rms_mm^2 = (sensed_rms_mm^2 - scatter^2) + (reported^2 - scatter^2),
/// each term at least 0, with the scatter of a needle that lies still and the spread that the sensor reports
/// of it, both of x and y together: what is reported holds from place to place, so what it is more than the
/// scatter is the part that stays. This takes the report for true; where there is none, that part is left
/// out. A calibration that is off as a whole is in neither, nor are trials that failed.
std::optional<runs::PointsFigures> points_figures(const std::vector<double>& sensed_mm, std::int64_t failed,
                                                  const std::optional<runs::StillFigures>& still);

}  // namespace lodestone::experiments
