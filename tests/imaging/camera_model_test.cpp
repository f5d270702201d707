#include "lodestone/imaging/camera_model.h"

#include <catch2/catch.hpp>
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
  common::Json json = imaging::to_json(calibration);
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
