#include "lodestone/imaging/camera_model.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"

namespace lodestone::imaging {
namespace {

bool within(const FluidLayer& fluid, const geometry::Vector2& point_m, double height_m) {
  return height_m < fluid.depth_m && point_m.norm() <= fluid.radius_m;
}

/// Where the ray from a point in the fluid leaves its surface towards the eye: Newton's method on how far
/// that is from below the eye.
Eigen::Vector3d surface_point_m(const FluidLayer& fluid, const Eigen::Vector3d& eye_m,
                                const Eigen::Vector3d& point_m) {
  const Eigen::Vector2d way_m = point_m.head<2>() - eye_m.head<2>();
  const double distance = way_m.norm(), n = fluid.refractive_index;
  const double above = eye_m.z() - fluid.depth_m, below = fluid.depth_m - point_m.z();
  double along = distance * above / (above + below / n);  // where the ray is steep
  for (int i = 0; i < 8 && distance > 0.0; ++i) {
    const double in_air = std::hypot(along, above), in_fluid = std::hypot(distance - along, below);
    const double miss = along / in_air - n * (distance - along) / in_fluid;
    const double slope = above * above / std::pow(in_air, 3) + n * below * below / std::pow(in_fluid, 3);
    along = std::clamp(along - miss / slope, 0.0, distance);
  }
  const Eigen::Vector2d at_m = eye_m.head<2>() + (distance > 0.0 ? along / distance : 0.0) * way_m;
  return {at_m.x(), at_m.y(), fluid.depth_m};
}

}  // namespace

Eigen::Vector2d CameraModel::project(const Eigen::Vector3d& point_m) const {
  const bool below = within(fluid, point_m.head<2>(), point_m.z());
  const Eigen::Vector3d shown_m = below ? surface_point_m(fluid, eye_m(), point_m) : point_m;
  const Eigen::Vector3d seen = rotation * shown_m + translation_m;
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
  const Eigen::Vector3d eye = eye_m();
  if (height_m < fluid.depth_m) {
    const double to_surface = (fluid.depth_m - eye.z()) / ray.z();
    const Eigen::Vector2d sine = ray.head<2>() / (ray.norm() * fluid.refractive_index);
    const Eigen::Vector2d point = eye.head<2>() + to_surface * ray.head<2>() +
                                  (fluid.depth_m - height_m) / std::sqrt(1.0 - sine.squaredNorm()) * sine;
    if (within(fluid, point, height_m)) return point;
  }
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
         k2 == other.k2 && fluid == other.fluid && rotation == other.rotation &&
         translation_m == other.translation_m;
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
  check("fluid.depth_m", camera.fluid.depth_m, 0, 0.1);
  check("fluid.radius_m", camera.fluid.radius_m, 0, 1);
  check("fluid.refractive_index", camera.fluid.refractive_index, 1, 3);
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
  if (camera.fluid.depth_m > 0.0)
    json["fluid"] = {{"depth_m", camera.fluid.depth_m},
                     {"radius_m", camera.fluid.radius_m},
                     {"refractive_index", camera.fluid.refractive_index}};
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
    if (json.contains("fluid"))
      camera.fluid = {json["fluid"].at("depth_m").get<double>(), json["fluid"].at("radius_m").get<double>(),
                      json["fluid"].at("refractive_index").get<double>()};
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
