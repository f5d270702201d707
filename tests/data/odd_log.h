#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lodestone/common/random.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::tests {

/// What really happened while a synthetic log was recorded.
struct TruePulse {
  double from_s = 0.0;
  double to_s = 0.0;
  geometry::Pose2 before, after;
  geometry::Vector2 drive_A;
};

/// How a synthetic log is written.
struct OddLogStyle {
  int pulses = 60;
  char separator = ',';
  char decimal = '.';
  std::string header =
      "Time [s],X [mm],Y [mm],Angle [deg],I_east [A],I_west [A],I_north [A],I_south [A],note";
  double time = 1.0, length = 1e3, angle = 180.0 / 3.14159265358979323846,
         current = 1.0;  ///< units in SI units
  double centre = 0.0;   ///< in the unit of lengths, of x and y
  bool y_down = false;
  bool signed_pairs = false;  ///< two columns of currents
  double lag_s = 9.3e-3;      ///< of the currents: what the coils of the paper's rig have
  double least_step_s = 0.015, most_step_s = 0.035;
};

/// A needle that every pulse of 0.3 s moves by 0.3 mm per ampere and turns, with rests between, seen by a
/// camera at irregular times.
class OddLog {
 public:
  static constexpr double kPulse_s = 0.3;

  explicit OddLog(OddLogStyle style = {}, std::uint64_t seed = 1)
      : style_(std::move(style)), random_(seed, "odd log") {
    geometry::Pose2 pose;
    double time_s = 0.05;
    for (int i = 0; i < style_.pulses; ++i) {
      const double rest_s = random_.below(3) == 0 ? 0.0 : random_.uniform(0.1, 0.9);
      time_s += rest_s;
      TruePulse pulse{time_s, time_s + kPulse_s, pose, pose, drive(pose)};
      pulse.after = {pose.x_m + 0.3e-3 * pulse.drive_A.x(), pose.y_m + 0.3e-3 * pulse.drive_A.y(),
                     geometry::wrap_angle(pose.heading_rad + 0.05 * pulse.drive_A.x())};
      pose = pulse.after;
      time_s = pulse.to_s;
      pulses.push_back(pulse);
    }
    end_s_ = time_s + 0.4;
    write();
  }

  std::vector<TruePulse> pulses;
  std::string csv;

 private:
  geometry::Vector2 drive(const geometry::Pose2& pose) {
    const auto axis = [&](double at_m) {
      const double size_A = random_.uniform(3.0, 14.0);
      return random_.uniform(-0.02, 0.02) > at_m ? size_A : -size_A;
    };
    const double x = axis(pose.x_m);
    return {x, random_.below(4) == 0 ? 0.0 : axis(pose.y_m)};
  }

  geometry::Pose2 pose_at(double time_s) const {
    geometry::Pose2 pose;
    for (const TruePulse& pulse : pulses) {
      if (time_s < pulse.from_s) break;
      const double part = std::min(1.0, (time_s - pulse.from_s) / kPulse_s);
      pose.x_m = pulse.before.x_m + part * (pulse.after.x_m - pulse.before.x_m);
      pose.y_m = pulse.before.y_m + part * (pulse.after.y_m - pulse.before.y_m);
      pose.heading_rad = geometry::wrap_angle(
          pulse.before.heading_rad +
          part * geometry::wrap_angle(pulse.after.heading_rad - pulse.before.heading_rad));
    }
    return pose;
  }

  geometry::Vector2 current_at(double time_s) const {
    geometry::Vector2 current_A = geometry::Vector2::Zero();
    for (const TruePulse& pulse : pulses) {
      const auto arrived = [&](double since_s) {
        return since_s <= 0.0 ? 0.0 : style_.lag_s > 0.0 ? 1.0 - std::exp(-since_s / style_.lag_s) : 1.0;
      };
      current_A += pulse.drive_A * (arrived(time_s - pulse.from_s) - arrived(time_s - pulse.to_s));
    }
    return current_A;
  }

  void cell(double value) {
    std::string text = fmt::format("{:.7f}", value);
    std::replace(text.begin(), text.end(), '.', style_.decimal);
    csv += text + style_.separator;
  }

  void write() {
    csv = style_.header;
    std::replace(csv.begin(), csv.end(), ',', style_.separator);
    csv += "\n";
    for (double t = 0.0; t < end_s_; t += random_.uniform(style_.least_step_s, style_.most_step_s)) {
      const geometry::Pose2 pose = pose_at(t);
      const geometry::Vector2 current_A = current_at(t);
      const double up = style_.y_down ? -1.0 : 1.0;
      cell(t * style_.time);
      cell(pose.x_m * style_.length + style_.centre);
      cell(up * pose.y_m * style_.length + style_.centre);
      cell(up * pose.heading_rad * style_.angle);
      for (int axis = 0; axis < 2; ++axis) {
        if (style_.signed_pairs) {
          cell(current_A[axis] * style_.current);
          continue;
        }
        cell(std::max(0.0, current_A[axis]) * style_.current);
        cell(std::max(0.0, -current_A[axis]) * style_.current);
      }
      csv += "a note\n";
    }
  }

  OddLogStyle style_;
  common::RandomStream random_;
  double end_s_ = 0.0;
};

}  // namespace lodestone::tests
