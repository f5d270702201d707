#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/imaging/bench.h"

namespace lodestone::vision {

/// What the segmentation network says of an area: log-odds per mask pixel.
struct Evidence {
  cv::Mat needle;  ///< [h, w] float: of being needle, hidden parts included
  cv::Mat tape;    ///< [h, w] float: of being the taped head
};

/// Where mask pixels lie in the dish frame: columns go to +x, rows to -y.
struct MaskGrid {
  geometry::Vector2 first_m = geometry::Vector2::Zero();  ///< centre of the pixel of row 0, column 0
  double pixel_m = 0.4e-3;

  geometry::Vector2 at(double column, double row) const {
    return {first_m.x() + pixel_m * column, first_m.y() - pixel_m * row};
  }
};

/// The needle as a rod of known size, and what counts as seeing one.
struct RodConfig {
  double inlier_m = 0.6e-3;
  double min_visible = 0.35;
  double min_support = 0.50;
  double min_head_certainty = 0.90;
  double sigma_scale = 1.0;

  template <class Visitor>
  void visit(Visitor& v) {
    v.retired("needle_length_m", "rig.needle.length_m");
    v.retired("needle_diameter_m", "rig.needle.diameter_m");
    v.retired("tape_length_m", "rig.needle.tape_length_m");
    v.field("inlier_m", inlier_m, "m", "mask pixels this near to a line support it", {1e-5, 0.02});
    v.field("min_visible", min_visible, "", "a smaller fraction of the needle's area is no needle",
            {0.0, 1.0});
    v.field("min_support", min_support, "", "mean probability along the rod below which it is no needle",
            {0.0, 1.0});
    v.field("min_head_certainty", min_head_certainty, "",
            "probability, by its tape in one image, that head and tail are told apart rightly, below which "
            "there is an "
            "axis and no pose",
            {0.5, 1.0});
    v.retired("continuity", "sensor.tracker.min_head_probability");
    v.field("sigma_scale", sigma_scale, "", "factor on the standard deviations of the result", {0.01, 100.0});
  }

  // No keys: the rig's, by rod_of().
  double needle_length_m = 0.0;
  double needle_diameter_m = 0.0;
  double tape_length_m = 0.0;
  bool sphere = false;
};

/// `config` with the needle's sizes of a bench.
RodConfig rod_of(const imaging::BenchGeometry& bench, RodConfig config = {});

/// A needle, or why there is none.
struct Rod {
  bool found = false;
  bool axis_found =
      false;           ///< also where its tape does not tell head from tail: the heading is the likelier one
  std::string reason;  ///< empty when found
  geometry::Pose2 pose;                                  ///< of the middle of the needle, dish frame
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of x_m, y_m, heading_rad
  double tape_log_odds = 0.0;   ///< >= 0: of the head being where the pose says, by the tape
  double head_certainty = 0.0;  ///< the same as a probability
  double support = 0.0;         ///< mean probability along the rod
};

/// The one needle, if there is one, and all that may be it.
struct RodFit : Rod {
  std::vector<Rod> candidates;  ///< where there are several, none is found
};

/// Mask -> clusters -> line by RANSAC (Fischler and Bolles, 1981), then weighted least squares -> the place
/// along the line where a rod of the needle's length explains the log-odds best -> head by the tape (section
/// IV-B1 of the paper; the rod's place and the covariance are additions). Sub-pixel: pixels count by their
/// probability. The same input always gives the same result. A sphere is fitted by fit_disc() (disc_fit.h).
RodFit fit_rod(const Evidence& evidence, const MaskGrid& grid, const RodConfig& config);

}  // namespace lodestone::vision
