#include "lodestone/imaging/camera_model.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"

namespace lodestone::imaging {

Eigen::Vector2d CameraModel::project(const Eigen::Vector3d& point_m) const {
  const Eigen::Vector3d seen = rotation * point_m + translation_m;
  const Eigen::Vector2d plane = seen.head<2>() / seen.z();
  const double r2 = plane.squaredNorm();
  const double stretch = 1.0 + r2 * (k1 + r2 * k2);
  return {centre_u_px + focal_px * stretch * plane.x(), centre_v_px + focal_px * stretch * plane.y()};
}

geometry::Vector2 CameraModel::to_dish(const Eigen::Vector2d& pixel, double height_m) const {
  const Eigen::Vector2d distorted((pixel.x() - centre_u_px) / focal_px, (pixel.y() - centre_v_px) / focal_px);
  // Newton's method on the radius; distortion is small, so that few steps reach rounding.
  const double target = distorted.norm();
  double r = target;
  for (int i = 0; i < 8; ++i) {
    const double r2 = r * r;
    const double value = r * (1.0 + r2 * (k1 + r2 * k2)) - target;
    const double slope = 1.0 + r2 * (3.0 * k1 + 5.0 * r2 * k2);
    r -= value / slope;
  }
  const double shrink = target > 0.0 ? r / target : 1.0;
  const Eigen::Vector3d ray =
      rotation.transpose() * Eigen::Vector3d(shrink * distorted.x(), shrink * distorted.y(), 1.0);
  const Eigen::Vector3d eye = -(rotation.transpose() * translation_m);
  const double distance = (height_m - eye.z()) / ray.z();
  return {eye.x() + distance * ray.x(), eye.y() + distance * ray.y()};
}

double CameraModel::pixel_size_m() const {
  const Eigen::Vector2d centre = project_floor(geometry::Vector2::Zero());
  return 0.5 *
         ((to_dish(centre + Eigen::Vector2d(0.5, 0.0)) - to_dish(centre - Eigen::Vector2d(0.5, 0.0))).norm() +
          (to_dish(centre + Eigen::Vector2d(0.0, 0.5)) - to_dish(centre - Eigen::Vector2d(0.0, 0.5))).norm());
}

bool CameraModel::operator==(const CameraModel& other) const {
  return width_px == other.width_px && height_px == other.height_px && focal_px == other.focal_px &&
         centre_u_px == other.centre_u_px && centre_v_px == other.centre_v_px && k1 == other.k1 &&
         k2 == other.k2 && rotation == other.rotation && translation_m == other.translation_m;
}

CameraModel moved(const CameraModel& camera, const Eigen::Vector3d& rotation_rad,
                  const Eigen::Vector3d& shift_m) {
  const Eigen::Matrix3d turn = (Eigen::AngleAxisd(rotation_rad.z(), Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(rotation_rad.y(), Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(rotation_rad.x(), Eigen::Vector3d::UnitX()))
                                   .toRotationMatrix();
  // Turned about the point of the floor it looks at: a tilted camera still sees the dish.
  CameraModel out = camera;
  out.rotation = camera.rotation * turn.transpose();
  out.translation_m = camera.translation_m - out.rotation * shift_m;
  return out;
}

namespace {

/// The values of which a camera over a bench is made, with room to spare. Others cost without end: an image
/// of the dish with 2^31 pixels to a focal length is shrunk a million times.
void check_camera(const CameraModel& camera, const std::string& what) {
  const auto check = [&what](const char* name, double value, double least, double most) {
    if (!(value >= least && value <= most))
      throw common::DataError(
          fmt::format("{}: {} = {:g} must be within {:g} .. {:g}; make a calibration with "
                      "`lodestone calibrate`",
                      what, name, value, least, most));
  };
  check("width_px", static_cast<double>(camera.width_px), 1, 32768);
  check("height_px", static_cast<double>(camera.height_px), 1, 32768);
  check("focal_px", camera.focal_px, 50, 1e6);
  check("centre_px", camera.centre_u_px, -1e5, 1e5);
  check("centre_px", camera.centre_v_px, -1e5, 1e5);
  check("k1", camera.k1, -100, 100);
  check("k2", camera.k2, -1e6, 1e6);
  check("translation_m", camera.translation_m.x(), -10, 10);
  check("translation_m", camera.translation_m.y(), -10, 10);
  check("translation_m", camera.translation_m.z(), 1e-3, 10);
  const bool rotation = (camera.rotation * camera.rotation.transpose()).isIdentity(1e-6);
  if (!rotation || !(camera.rotation.determinant() > 0.0))
    throw common::DataError(what + ": rotation is none; make a calibration with `lodestone calibrate`");
  check("the side of a pixel on the dish, in m,", camera.pixel_size_m(), 1e-6, 0.01);
}

}  // namespace

common::Json to_json(const Calibration& calibration) {
  const CameraModel& camera = calibration.camera;
  common::Json json;
  json["method"] = calibration.method;
  json["reprojection_rms_mm"] = 1e3 * calibration.reprojection_rms_m;
  json["reprojection_rms_px"] = calibration.reprojection_rms_px;
  json["width_px"] = camera.width_px;
  json["height_px"] = camera.height_px;
  json["focal_px"] = camera.focal_px;
  json["centre_px"] = {camera.centre_u_px, camera.centre_v_px};
  json["k1"] = camera.k1;
  json["k2"] = camera.k2;
  json["rotation"] = common::Json::array();
  for (int row = 0; row < 3; ++row)
    json["rotation"].push_back({camera.rotation(row, 0), camera.rotation(row, 1), camera.rotation(row, 2)});
  json["translation_m"] = {camera.translation_m.x(), camera.translation_m.y(), camera.translation_m.z()};
  return json;
}

Calibration calibration_from_json(const common::Json& json, const std::string& what) {
  Calibration calibration;
  CameraModel& camera = calibration.camera;
  try {
    calibration.method = json.at("method").get<std::string>();
    calibration.reprojection_rms_m = 1e-3 * json.at("reprojection_rms_mm").get<double>();
    calibration.reprojection_rms_px = json.at("reprojection_rms_px").get<double>();
    camera.width_px = json.at("width_px").get<std::int64_t>();
    camera.height_px = json.at("height_px").get<std::int64_t>();
    camera.focal_px = json.at("focal_px").get<double>();
    camera.centre_u_px = json.at("centre_px").at(0).get<double>();
    camera.centre_v_px = json.at("centre_px").at(1).get<double>();
    camera.k1 = json.at("k1").get<double>();
    camera.k2 = json.at("k2").get<double>();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        camera.rotation(row, column) = json.at("rotation").at(row).at(column).get<double>();
      camera.translation_m(row) = json.at("translation_m").at(row).get<double>();
    }
  } catch (const common::Json::exception& error) {
    throw common::DataError(what + " is no calibration: " + error.what() +
                            "; make one with `lodestone calibrate`");
  }
  check_camera(camera, what);
  return calibration;
}

Calibration read_calibration(const std::string& file) {
  return calibration_from_json(common::read_json_file(file), file);
}

void write_calibration(const std::string& file, const Calibration& calibration) {
  common::write_file_atomically(file, to_json(calibration).dump(1) + "\n");
}

}  // namespace lodestone::imaging
