#include "lodestone/imaging/calibration_board.h"

#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

imaging::CameraModel true_camera() {
  imaging::CameraModel camera;
  camera.width_px = 640;
  camera.height_px = 512;
  camera.focal_px = 2300.0;
  camera.centre_u_px = 325.0;
  camera.centre_v_px = 251.0;
  camera.k1 = 0.5;
  camera.translation_m = {0.0, 0.0, 0.40};
  return camera;
}

imaging::BoardConfig board_of(imaging::BoardKind kind) {
  imaging::BoardConfig config;
  config.kind = kind;
  return config;
}

/// The board lying on the floor, seen by `camera`, on grey.
cv::Mat image_of_board(const imaging::BoardConfig& config, const imaging::CameraModel& camera) {
  imaging::BoardConfig coarse = config;
  coarse.dpi = 300.0;
  const cv::Mat board = imaging::draw_board(coarse);
  const double pixels_per_m = board.cols / (config.square_m * static_cast<double>(config.squares_x + 2));
  cv::Mat map(static_cast<int>(camera.height_px), static_cast<int>(camera.width_px), CV_32FC2);
  for (int v = 0; v < map.rows; ++v) {
    for (int u = 0; u < map.cols; ++u) {
      const geometry::Vector2 point = camera.to_dish({u, v});
      map.at<cv::Vec2f>(v, u) = {static_cast<float>(0.5 * (board.cols - 1) + pixels_per_m * point.x()),
                                 static_cast<float>(0.5 * (board.rows - 1) - pixels_per_m * point.y())};
    }
  }
  cv::Mat soft;
  cv::GaussianBlur(board, soft, {}, 1.0);
  cv::Mat image;
  cv::remap(soft, image, map, {}, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(128));
  return image;
}

}  // namespace

TEST_CASE("the printed board holds its resolution and reads back") {
  const tests::TemporaryFolder folder;
  const imaging::BoardConfig config;
  imaging::write_board(folder / "board.png", config);
  const cv::Mat board = cv::imread(folder / "board.png", cv::IMREAD_GRAYSCALE);
  REQUIRE(board.cols == 10 * 189);  // 8 mm at 600 dpi are 189 pixels
  const std::string bytes = common::read_file(folder / "board.png");
  const std::size_t at = bytes.find("pHYs");
  REQUIRE(at != std::string::npos);
  const auto byte = [&](std::size_t i) {
    return static_cast<unsigned>(static_cast<unsigned char>(bytes[i]));
  };
  CHECK(((byte(at + 4) << 24) | (byte(at + 5) << 16) | (byte(at + 6) << 8) | byte(at + 7)) == 23625);
}

TEST_CASE("corners are named by their place on the print, of every kind of board") {
  const auto [config, count] = GENERATE(std::pair{board_of(imaging::BoardKind::kCharuco), 35},
                                        std::pair{board_of(imaging::BoardKind::kCheckerboard), 35},
                                        std::pair{board_of(imaging::BoardKind::kAprilTag), 4 * 48});
  const imaging::CameraModel camera = true_camera();
  const imaging::BoardCorners corners = imaging::detect_board(image_of_board(config, camera), config);
  REQUIRE(corners.ids.size() == static_cast<std::size_t>(count));
  double farthest_px = 0.0;
  for (std::size_t i = 0; i < corners.ids.size(); ++i)
    farthest_px =
        std::max(farthest_px, (camera.project_floor(corners.board_m[i]) - corners.pixels[i]).norm());
  CHECK(farthest_px < (config.kind == imaging::BoardKind::kAprilTag ? 0.6 : 0.15));
}

TEST_CASE("images of the board give intrinsics, distortion and pose") {
  const imaging::BoardConfig config = board_of(GENERATE(
      imaging::BoardKind::kCharuco, imaging::BoardKind::kCheckerboard, imaging::BoardKind::kAprilTag));
  const imaging::CameraModel camera = true_camera();
  std::vector<cv::Mat> images;
  std::vector<imaging::CameraModel> poses;
  for (const Eigen::Vector3d& turn :
       {Eigen::Vector3d(0.0, 0.0, 0.05), Eigen::Vector3d(0.45, 0.0, 0.0), Eigen::Vector3d(-0.45, 0.1, 0.3),
        Eigen::Vector3d(0.0, 0.45, -0.2), Eigen::Vector3d(0.1, -0.45, 0.1), Eigen::Vector3d(0.3, 0.3, 0.8)}) {
    poses.push_back(imaging::moved(camera, turn, {0.004 * turn.x(), 0.003, 0.01 * turn.z()}));
    images.push_back(image_of_board(config, poses.back()));
  }
  const imaging::BoardFit fit = imaging::fit_board(images, config);
  CHECK(fit.used.size() == images.size());
  CHECK(fit.rms_px < 0.1);
  CHECK(fit.camera.focal_px == Approx(camera.focal_px).epsilon(0.005));
  CHECK(fit.camera.centre_u_px == Approx(camera.centre_u_px).margin(10.0));
  CHECK(fit.camera.centre_v_px == Approx(camera.centre_v_px).margin(10.0));
  CHECK(fit.camera.k1 == Approx(camera.k1).margin(0.1));
  const imaging::CameraModel posed = imaging::board_pose(images[1], config, fit.camera);
  for (const double x : {-0.03, 0.0, 0.03}) {
    const geometry::Vector2 point(x, 0.02);
    CHECK((posed.to_dish(poses[1].project_floor(point)) - point).norm() <
          (config.kind == imaging::BoardKind::kAprilTag ? 1e-4 : 5e-5));
  }
}

TEST_CASE("images without a board are refused with the remedy") {
  const imaging::BoardConfig config;
  const std::vector<cv::Mat> empty(4, cv::Mat(512, 640, CV_8UC1, cv::Scalar(128)));
  CHECK_THROWS_WITH(imaging::fit_board(empty, config), Catch::Contains("0 of 4 images"));
  CHECK_THROWS_AS(imaging::board_pose(empty[0], config, {}), common::DataError);
  imaging::BoardConfig wrong;
  wrong.marker_m = wrong.square_m;
  CHECK_THROWS_AS(imaging::draw_board(wrong), common::ConfigError);
  wrong.kind = imaging::BoardKind::kCheckerboard;  // has no markers
  CHECK_NOTHROW(imaging::draw_board(wrong));
  wrong.squares_y = 3;
  CHECK_THROWS_WITH(imaging::draw_board(wrong), Catch::Contains("be at least 4"));
  wrong.squares_y = wrong.squares_x;
  CHECK_THROWS_WITH(imaging::draw_board(wrong), Catch::Contains("looks alike on its side"));
  imaging::BoardConfig many = board_of(imaging::BoardKind::kAprilTag);
  many.squares_x = many.squares_y = 24;
  CHECK_NOTHROW(many.validate());
  many.kind = imaging::BoardKind::kCharuco;
  CHECK_THROWS_WITH(many.validate(), Catch::Contains("the dictionary has 50 markers"));
}

TEST_CASE("views of a board that hardly differ are one") {
  const imaging::BoardConfig config;
  const imaging::CameraModel camera = true_camera();
  const auto seen = [&](double aside_m) {
    return imaging::detect_board(
        image_of_board(config, imaging::moved(camera, {0.0, 0.0, 0.0}, {aside_m, 0.0, 0.0})), config);
  };
  const imaging::BoardCorners first = seen(0.0);
  CHECK(imaging::is_another_view(first, {}, 640));
  CHECK_FALSE(imaging::is_another_view(seen(0.001), {first}, 640));
  CHECK(imaging::is_another_view(seen(0.010), {first}, 640));
  const cv::Mat tilted = image_of_board(config, imaging::moved(camera, {0.45, 0.0, 0.0}, {0.0, 0.0, 0.0}));
  CHECK(imaging::is_another_view(imaging::detect_board(tilted, config), {first}, 640));
  CHECK_FALSE(imaging::is_another_view({}, {}, 640));
}

TEST_CASE("of a board that lies in the dish it is seen how large it was printed") {
  const imaging::BoardConfig config = board_of(GENERATE(
      imaging::BoardKind::kCharuco, imaging::BoardKind::kCheckerboard, imaging::BoardKind::kAprilTag));
  constexpr double kDish_m = 0.05;
  const imaging::CameraModel camera = true_camera();
  const auto size_of = [&](const imaging::BoardConfig& printed, const imaging::CameraModel& seen_by) {
    return imaging::size_on_floor(imaging::detect_board(image_of_board(printed, seen_by), config), camera,
                                  kDish_m);
  };
  imaging::BoardConfig small = config;
  small.square_m *= 0.97;
  small.marker_m *= 0.97;
  CHECK(size_of(config, camera).value() == Approx(1.0).epsilon(0.002));
  CHECK(size_of(small, camera).value() == Approx(0.97).epsilon(0.002));
  CHECK(size_of(small, imaging::moved(camera, {0.0, 0.0, 0.4}, {0.002, 0.001, 0.0})).value() ==
        Approx(0.97).epsilon(0.002));
  CHECK_FALSE(size_of(config, imaging::moved(camera, {0.2, 0.0, 0.0}, {})));  // tilted
  CHECK_FALSE(imaging::size_on_floor(imaging::detect_board(image_of_board(config, camera), config), camera,
                                     0.02));  // beyond the rim
}
