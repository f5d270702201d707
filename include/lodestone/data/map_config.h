#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::data {

enum class Separator { kAuto, kComma, kSemicolon, kTab, kBar, kBlank };
inline std::vector<std::string> names_of(Separator) {
  return {"auto", "comma", "semicolon", "tab", "bar", "blank"};
}
enum class Decimal { kAuto, kPoint, kComma };
inline std::vector<std::string> names_of(Decimal) { return {"auto", "point", "comma"}; }
/// What a current below zero means: a mistake, or that the opposite coil is on.
enum class NegativeCurrent { kRefuse, kOpposite };
inline std::vector<std::string> names_of(NegativeCurrent) { return {"refuse", "opposite"}; }
/// What opposite coils that are on together mean: a mistake, or their difference.
enum class OppositeCurrents { kRefuse, kNet };
inline std::vector<std::string> names_of(OppositeCurrents) { return {"refuse", "net"}; }

/// How a log of any layout is read (`import --map`).
struct MapConfig {
  std::string columns;
  std::string units;
  Separator separator = Separator::kAuto;
  Decimal decimal = Decimal::kAuto;
  std::int64_t header_line = 1;
  NegativeCurrent negative_current = NegativeCurrent::kRefuse;
  OppositeCurrents opposite_currents = OppositeCurrents::kRefuse;
  double pixel_m = 0.0;
  std::string calibration;
  double pulse_s = 0.0;
  double tolerance = 0.2;
  double longest_gap_s = 0.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("columns", columns, "",
            "which columns mean what: time=Time [s],x=X_px,y=Y_px,heading=A [deg],currents=I1|I2|I3|I4");
    v.field("units", units, "", "units that the header does not say: time=ms,x=px,y=px,currents=%");
    v.field("separator", separator, "", "what stands between cells; auto: the one that gives every column");
    v.field("decimal", decimal, "", "decimal sign of the numbers");
    v.field("header_line", header_line, "",
            "line of the header; 0: there is none, and columns are called 1, 2, ...", {0, 1000});
    v.field("negative_current", negative_current, "",
            "a current below zero: refused, or the opposite coil of its pair is on");
    v.field("opposite_currents", opposite_currents, "",
            "opposite coils on together: refused, or their difference counts");
    v.field("pixel_m", pixel_m, "m", "length of a pixel on the dish floor, where positions are in px",
            {0.0, 0.1});
    v.field("calibration", calibration, "", "calibration.json of the camera whose pixels positions are in");
    v.field(
        "pulse_s", pulse_s, "s",
        "how long the current of a step is on, and then off for the rest of control_period_s; 0: throughout",
        {0.0, 60.0});
    v.field("tolerance", tolerance, "", "how far a pulse may be from its length, as a fraction of it",
            {0.0, 0.5});
    v.field(
        "longest_gap_s", longest_gap_s, "s",
        "rows that are further apart are not connected; 0: one and a half usual distances, or half a pulse",
        {0.0, 60.0});
    v.retired("plausible", "plausible, for every layout");
  }
  /// Throws ConfigError where pixels have two sizes.
  void validate() const {
    if (pixel_m > 0.0 && !calibration.empty())
      throw common::InvalidConfig("pixel_m", pixel_m, "be 0 where calibration is given, which says it, too");
  }

  // No key: what the calibration says.
  /// Pose in the dish of a pixel (u right, v down) and an angle, counter-clockwise as the image shows it.
  std::function<geometry::Pose2(double u_px, double v_px, double angle_rad)> to_dish;
};

}  // namespace lodestone::data
