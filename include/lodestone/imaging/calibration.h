#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "lodestone/common/config.h"
#include "lodestone/imaging/bench.h"
#include "lodestone/imaging/camera_model.h"
#include "lodestone/imaging/scene.h"

namespace lodestone::imaging {

/// How the camera is fitted to dish and coils.
struct CalibrationConfig {
  double focal_sigma = 0.005;      // D: lenses hold their focal length to a few per mille
  double k1_sigma = 1.0;           // D: weak
  double max_rms_px = 0.5;         // D: five times what a good image leaves
  double min_found = 0.5;          // D
  double moved_bound_m = 0.30e-3;  // D: twice the aimed error of a calibration

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("focal_sigma", focal_sigma, "", "how far the focal length may be from nominal, relative",
            {1e-6, 0.2});
    v.field("k1_sigma", k1_sigma, "", "how far the radial distortion k1 may be from nominal", {1e-6, 100.0});
    v.field("max_rms_px", max_rms_px, "px", "largest residual of a fit that is accepted", {0.01, 20.0});
    v.field("min_found", min_found, "", "fraction of the dish's predicted edges that must be found",
            {0.05, 1.0});
    v.field("moved_bound_m", moved_bound_m, "m", "shift from which the camera counts as moved", {1e-6, 0.1});
  }
};

/// How one visible edge of the bench took part in a fit.
struct EdgeUse {
  std::string name;           ///< "floor", "rim inside", "rim outside", "coil +x", ...
  std::int64_t expected = 0;  ///< points that should be in view
  std::int64_t used = 0;      ///< points found, and not rejected as outliers
  double rms_px = 0.0;        ///< of the used
};

struct DishFit {
  Calibration calibration;
  std::vector<EdgeUse> edges;
};

/// Fits the camera's pose, focal length and k1 to the edges of dish and coils: rim circles, floor circle and
/// the coils' base lines, each found to a fraction of a pixel across its predicted place, by a robust
/// Gauss-Newton method (Tukey's weights). `start` gives what is known: intrinsics, height, and a mounting
/// turned by less than 45 degrees (dish and coils look alike every 90).
///
/// `images`: 8-bit BGR or grey, of the size of `start`; several are averaged, the camera must stand still.
/// With `hold_intrinsics` only the pose is fitted. Fluid as the bench has it, or where that has none, as
/// `start` has it, is looked through. Throws DataError when an image cannot be used, the dish
/// is not found, too few edges are in view, or the residual is above config.max_rms_px.
DishFit fit_dish(const std::vector<cv::Mat>& images, const BenchGeometry& bench, const CameraModel& start,
                 const CalibrationConfig& config = {}, bool hold_intrinsics = false);

/// fit_dish() from the nominal mounting.
Calibration calibrate_from_dish(const std::vector<cv::Mat>& images, const BenchGeometry& bench,
                                const LensConfig& nominal, const CalibrationConfig& config = {});

/// Distance on the dish floor between where two cameras see the same pixel.
struct FloorError {
  double rms_m = 0.0;
  double max_m = 0.0;
};
FloorError floor_error(const CameraModel& camera, const CameraModel& truth, const BenchGeometry& bench);

/// How far, in metres RMS over the dish floor, the image has moved since the calibration was made: the pose
/// is fitted anew with the intrinsics held. Compare with CalibrationConfig::moved_bound_m. Throws as
/// fit_dish() does.
double camera_moved_m(const cv::Mat& image, const Calibration& calibration, const BenchGeometry& bench,
                      const CalibrationConfig& config = {});

}  // namespace lodestone::imaging
