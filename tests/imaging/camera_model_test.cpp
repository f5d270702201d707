#include "lodestone/imaging/camera_model.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "lodestone/common/error.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

imaging::CameraModel tilted() {
  imaging::CameraModel camera;
  camera.k1 = 0.5;
  camera.k2 = -0.8;
  return imaging::moved(camera, {0.05, -0.04, 0.08}, {0.004, -0.003, 0.01});
}

}  // namespace

TEST_CASE("the nominal camera looks straight down with x to the right and y up in the image") {
  const imaging::CameraModel camera;
  CHECK(camera.pixel_size_m() == Approx(0.1e-3).epsilon(1e-3));
  CHECK((camera.project_floor(geometry::Vector2(0.0, 0.0)) - Eigen::Vector2d(639.5, 511.5)).norm() < 1e-9);
  CHECK((camera.project_floor(geometry::Vector2(0.01, 0.0)) - Eigen::Vector2d(739.5, 511.5)).norm() < 1e-6);
  CHECK((camera.project_floor(geometry::Vector2(0.0, 0.01)) - Eigen::Vector2d(639.5, 411.5)).norm() < 1e-6);
}

TEST_CASE("a pixel's point of the dish projects back onto the pixel") {
  const imaging::CameraModel camera = tilted();
  for (const double height_m : {0.0, 0.01}) {
    for (double u = 0.0; u < 1280.0; u += 159.0) {
      for (double v = 0.0; v < 1024.0; v += 127.0) {
        const geometry::Vector2 point = camera.to_dish({u, v}, height_m);
        const Eigen::Vector2d back = camera.project(Eigen::Vector3d(point.x(), point.y(), height_m));
        CHECK((back - Eigen::Vector2d(u, v)).norm() < 1e-6);
      }
    }
  }
}

TEST_CASE("what lies in the fluid is seen along a ray that obeys Snell's law") {
  imaging::CameraModel camera;  // 0.4717 m above the dish centre
  camera.fluid = {0.005, 0.0425, 1.36};
  const geometry::Vector2 point_m(0.03, -0.02);
  const Eigen::Vector2d pixel = camera.project_floor(point_m);
  // Straight through the air to the surface, then towards the vertical.
  imaging::CameraModel air = camera;
  air.fluid = {};
  const geometry::Vector2 surface_m = air.to_dish(pixel, 0.005);
  const double tangent_air = surface_m.norm() / (0.4717 - 0.005);
  const double tangent_fluid = (point_m - surface_m).norm() / 0.005;
  CHECK(std::sin(std::atan(tangent_air)) == Approx(1.36 * std::sin(std::atan(tangent_fluid))).epsilon(1e-6));
  // The fluid makes the floor look nearer, so what is off the middle lies further out in the image.
  CHECK((pixel - air.project_floor({0.0, 0.0})).norm() >
        (air.project_floor(point_m) - air.project_floor({0.0, 0.0})).norm());
  CHECK(camera.project_floor({0.0, 0.0}) == air.project_floor({0.0, 0.0}));
  // What stands above the surface, or beside the dish, is seen as ever.
  CHECK(camera.project({0.03, -0.02, 0.006}) == air.project({0.03, -0.02, 0.006}));
  CHECK(camera.project_floor({0.05, 0.0}) == air.project_floor({0.05, 0.0}));
}

TEST_CASE("through fluid, too, a pixel's point of the dish projects back onto the pixel") {
  imaging::CameraModel camera = tilted();
  camera.fluid = {0.006, 0.0425, 1.36};
  for (double radius_m : {0.0, 0.01, 0.025, 0.041})
    for (int turn = 0; turn < 12; ++turn)
      for (const double height_m : {0.0, 0.002, 0.009}) {
        const double angle_rad = 0.5235987756 * turn;
        const geometry::Vector2 point_m(radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad));
        const Eigen::Vector2d pixel = camera.project(Eigen::Vector3d(point_m.x(), point_m.y(), height_m));
        CHECK((camera.to_dish(pixel, height_m) - point_m).norm() < 1e-9);
      }
}

TEST_CASE("a camera that moves to +x sees the dish further left") {
  const imaging::CameraModel camera = imaging::moved({}, {0.0, 0.0, 0.0}, {0.005, 0.0, 0.0});
  CHECK(camera.project_floor(geometry::Vector2(0.0, 0.0)).x() == Approx(589.5).margin(0.01));
}

TEST_CASE("a calibration survives its file, and a damaged one is named") {
  const tests::TemporaryFolder folder;
  imaging::Calibration calibration;
  calibration.camera = tilted();
  calibration.method = "dish";
  calibration.reprojection_rms_m = 3e-5;
  const std::string file = folder.path() + "/calibration.json";
  imaging::write_calibration(file, calibration);
  CHECK(imaging::read_calibration(file).camera == calibration.camera);
  calibration.camera.fluid = {0.005, 0.043, 1.36};
  imaging::write_calibration(file, calibration);
  CHECK(imaging::read_calibration(file).camera == calibration.camera);
  common::Json json = imaging::to_json(calibration);
  json["fluid"]["refractive_index"] = 0.5;
  CHECK_THROWS_WITH(imaging::calibration_from_json(json, "here"),
                    Catch::Contains("here: fluid.refractive_index = 0.5 must be within 1 .. 3"));
  json = imaging::to_json(calibration);
  json.erase("k1");
  CHECK_THROWS_AS(imaging::calibration_from_json(json, "here"), common::DataError);
  json = imaging::to_json(calibration);
  json["rotation"][0][0] = 2.0;
  CHECK_THROWS_AS(imaging::calibration_from_json(json, "here"), common::DataError);
  for (const auto& [key, value] : std::map<std::string, common::Json>{{"focal_px", 2147483648.0},
                                                                      {"width_px", 1e9},
                                                                      {"height_px", 0},
                                                                      {"k1", 1e300},
                                                                      {"centre_px", {1e300, 0}},
                                                                      {"translation_m", {0, 0, 1e300}}}) {
    json = imaging::to_json(calibration);
    json[key] = value;
    CHECK_THROWS_WITH(imaging::calibration_from_json(json, "here"),
                      Catch::Contains("here: " + key) && Catch::Contains("must be within"));
  }
}
