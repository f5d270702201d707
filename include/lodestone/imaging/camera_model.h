#pragma once

#include <Eigen/Core>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/geometry/pose2.h"

namespace lodestone::imaging {

/// Fluid that the floor is seen through; none where its depth is 0.
struct FluidLayer {
  double depth_m = 0.0;   ///< of its surface above the floor
  double radius_m = 0.0;  ///< about the dish centre
  double refractive_index = 1.0;

  bool operator==(const FluidLayer& other) const {
    return depth_m == other.depth_m && radius_m == other.radius_m &&
           refractive_index == other.refractive_index;
  }
};

/// Where a point of the dish frame lands in the image: a pinhole with radial distortion, over a flat surface
/// of fluid.
///
/// Pixel coordinates: the centre of the top left pixel is (0, 0), u to the right, v downwards. The dish frame
/// has its origin at the centre of the dish floor, z upwards. Camera frame: x right, y down, z forward.
/// Distortion (Brown): (x, y) -> (1 + k1 r^2 + k2 r^4) (x, y) on the plane at distance 1. What lies in the
/// fluid is seen where its ray leaves the surface (Snell's law).
struct CameraModel {
  std::int64_t width_px = 1280;
  std::int64_t height_px = 1024;
  double focal_px = 4717.0;  // D: 25 mm lens, pixels of 5.3 um
  double centre_u_px = 639.5;
  double centre_v_px = 511.5;
  double k1 = 0.0;
  double k2 = 0.0;
  Eigen::Matrix3d rotation = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();  ///< dish frame -> camera frame
  Eigen::Vector3d translation_m = {0.0, 0.0, 0.4717};  ///< dish origin in the camera frame
  FluidLayer fluid;

  /// Pixel of a point given in the dish frame, in metres. The point must lie in front of the camera.
  Eigen::Vector2d project(const Eigen::Vector3d& point_m) const;
  Eigen::Vector2d project_floor(const geometry::Vector2& floor_point_m) const {
    return project(Eigen::Vector3d(floor_point_m.x(), floor_point_m.y(), 0.0));
  }
  /// Point of the plane at height `height_m` above the floor that is seen at `pixel`.
  geometry::Vector2 to_dish(const Eigen::Vector2d& pixel, double height_m = 0.0) const;

  /// Length on the floor of one pixel at the dish centre, in metres.
  double pixel_size_m() const;
  bool operator==(const CameraModel& other) const;

 private:
  Eigen::Vector3d eye_m() const { return -(rotation.transpose() * translation_m); }
};

/// Turns a camera about the dish axes (x, then y, then z; radians) and then moves it, seen in the dish frame.
CameraModel moved(const CameraModel& camera, const Eigen::Vector3d& rotation_rad,
                  const Eigen::Vector3d& shift_m);

/// An image's measured relation to the dish, as `lodestone calibrate` writes it.
struct Calibration {
  CameraModel camera;
  double reprojection_rms_m = 0.0;  ///< of the features it was fitted to, on the dish floor
  double reprojection_rms_px = 0.0;
  std::string method;  ///< "dish", or the kind of board that gave the lens
};

common::Json to_json(const Calibration& calibration);
/// Throws DataError naming `what` when a key is missing or a number is not finite.
Calibration calibration_from_json(const common::Json& json, const std::string& what);
/// Reads a file that `lodestone calibrate` wrote. Throws IoError, ConfigError, DataError.
Calibration read_calibration(const std::string& file);
void write_calibration(const std::string& file, const Calibration& calibration);

}  // namespace lodestone::imaging
