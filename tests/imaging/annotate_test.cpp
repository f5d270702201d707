#include "lodestone/imaging/annotate.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "lodestone/common/error.h"
#include "paper_scenes.h"
#include "sphere_rig.h"

using namespace lodestone;

namespace {

const cv::Scalar kGrey(150, 150, 150);

struct Drawing {
  imaging::CameraModel camera;
  imaging::Annotation annotation = [] {
    imaging::Annotation of_paper;
    of_paper.bench = tests::paper_bench();
    return of_paper;
  }();
  cv::Mat image;

  explicit Drawing(int scale = 1) {
    camera.width_px /= scale;
    camera.height_px /= scale;
    camera.focal_px /= scale;
    camera.centre_u_px = 0.5 * (camera.width_px - 1);
    camera.centre_v_px = 0.5 * (camera.height_px - 1);
  }
  void draw() {
    image = cv::Mat(static_cast<int>(camera.height_px), static_cast<int>(camera.width_px), CV_8UC3, kGrey);
    imaging::annotate(image, camera, annotation);
  }
  cv::Vec3b at(double x_m, double y_m) const {
    const Eigen::Vector2d pixel = camera.project_floor({x_m, y_m});
    return image.at<cv::Vec3b>(static_cast<int>(std::lround(pixel.y())),
                               static_cast<int>(std::lround(pixel.x())));
  }
  /// Pixels around a point that were drawn into.
  int drawn(double x_m, double y_m, int half_px) const {
    const Eigen::Vector2d pixel = camera.project_floor({x_m, y_m});
    const cv::Rect area(static_cast<int>(pixel.x()) - half_px, static_cast<int>(pixel.y()) - half_px,
                        2 * half_px + 1, 2 * half_px + 1);
    const cv::Mat part = image(area & cv::Rect(0, 0, image.cols, image.rows));
    int count = 0;
    for (int row = 0; row < part.rows; ++row) {
      for (int column = 0; column < part.cols; ++column)
        count += part.at<cv::Vec3b>(row, column) != cv::Vec3b(150, 150, 150) ? 1 : 0;
    }
    return count;
  }
};

bool reddish(const cv::Vec3b& bgr) { return bgr[2] > bgr[0] + 80; }
bool bluish(const cv::Vec3b& bgr) { return bgr[0] > bgr[2] + 80; }
bool yellow(const cv::Vec3b& bgr) { return bgr[2] > 200 && bgr[1] > 190 && bgr[0] < 120; }

}  // namespace

TEST_CASE("each thing of an annotation is drawn where it is on the floor") {
  Drawing drawing;
  drawing.annotation.pose = geometry::Pose2{0.010, 0.005, 0.5 * 3.14159265358979};
  drawing.annotation.target_m = geometry::Vector2(-0.02, 0.01);
  drawing.annotation.reference_m = {{-0.03, -0.02}, {0.03, -0.02}};
  drawing.annotation.travelled_m = {{{-0.03, -0.03}, {0.02, -0.03}}};
  drawing.draw();
  const double half_m = 0.5 * drawing.annotation.bench.needle_length_m;
  CHECK(yellow(drawing.at(0.010, 0.005 + half_m)));         // head
  CHECK(reddish(drawing.at(0.010, 0.005 - 0.8 * half_m)));  // towards the tail
  CHECK_FALSE(yellow(drawing.at(0.010, 0.005 - half_m)));
  CHECK(bluish(drawing.at(0.005, -0.02)));
  CHECK(reddish(drawing.at(0.005, -0.03)));  // orange
  CHECK(drawing.drawn(-0.02, 0.01, 3) > 0);
  CHECK(drawing.drawn(0.0, 0.0425, 3) > 0);  // rim
  CHECK(drawing.drawn(0.0, 0.035, 3) == 0);  // and nothing where nothing is
}

TEST_CASE("a sphere is a ring, without a head") {
  Drawing drawing;
  drawing.annotation.bench = rig::bench_of(tests::sphere_rig());
  drawing.annotation.pose = geometry::Pose2{0.010, 0.005, 0.0};
  drawing.draw();
  for (const double off_m : {-1.5e-3, 0.0, 1.5e-3}) {
    CHECK(reddish(drawing.at(0.010 + off_m, 0.005)));
    CHECK(reddish(drawing.at(0.010, 0.005 + off_m)));
  }
  CHECK(drawing.drawn(0.010 + 4e-3, 0.005, 3) == 0);
}

TEST_CASE("headings that are wanted are drawn from where they are wanted") {
  Drawing drawing;
  drawing.annotation.target_m = geometry::Vector2(0.0, 0.01);
  drawing.annotation.reference_m = {{-0.03, -0.02}, {0.03, -0.02}};
  drawing.draw();
  CHECK(drawing.drawn(0.0, 0.01 + 0.0075, 2) == 0);
  CHECK(drawing.drawn(0.01, -0.0175, 2) == 0);
  drawing.annotation.target_heading_rad = 0.5 * geometry::kPi;
  drawing.annotation.reference_headings.push_back({0.01, -0.02, 0.5 * geometry::kPi});
  drawing.draw();
  CHECK(drawing.drawn(0.0, 0.01 + 0.0075, 2) > 0);
  CHECK(bluish(drawing.at(0.01, -0.0175)));
  CHECK(drawing.drawn(0.0, 0.01 - 0.0075, 2) == 0);  // towards the tail there is nothing
  drawing.annotation.target_m.reset();
  drawing.draw();
  CHECK(drawing.drawn(0.0, 0.01 + 0.0075, 2) == 0);
}

TEST_CASE("a frame shows how sure the pose is, and where the needle was while it is not seen") {
  Drawing drawing;
  const double far_m = 0.012;  // beside the needle, which lies along x
  drawing.annotation.pose = geometry::Pose2{};
  drawing.annotation.last_seen_m = geometry::Vector2(0.02, 0.02);
  drawing.draw();
  CHECK(drawing.drawn(0.0, far_m, 3) == 0);
  drawing.annotation.position_sigma_m = 0.5 * far_m;
  drawing.draw();
  CHECK(reddish(drawing.at(0.0, far_m)));
  const double half_m = 0.5 * drawing.annotation.bench.needle_length_m;
  CHECK(drawing.drawn(0.02, 0.02 + half_m, 3) == 0);
  drawing.annotation.pose.reset();
  drawing.draw();
  CHECK(yellow(drawing.at(0.02, 0.02 + half_m)));
  CHECK(drawing.drawn(0.0, far_m, 3) == 0);
}

TEST_CASE("the way between two stretches that were seen is dashed") {
  Drawing drawing;
  drawing.annotation.travelled_m = {{{-0.03, 0.01}, {-0.01, 0.01}}, {{0.01, 0.01}, {0.03, 0.01}}, {}};
  drawing.draw();
  CHECK(drawing.drawn(-0.02, 0.01, 40) > 1.3 * drawing.drawn(0.0, 0.01, 40));
  CHECK(drawing.drawn(0.0, 0.01, 40) > 0);
}

TEST_CASE("arrows of the currents point out for positive ones and grow with them") {
  Drawing drawing;
  drawing.annotation.coil_current_A = {15.0, -15.0, 0.0, 3.0};
  drawing.draw();
  CHECK(reddish(drawing.at(0.046, 0.0)));
  CHECK(bluish(drawing.at(-0.048, 0.0)));
  CHECK(drawing.drawn(0.0, 0.0475, 8) == 0);
  CHECK(reddish(drawing.at(0.0, -0.045)));
  CHECK(drawing.drawn(0.0, -0.049, 3) == 0);  // a fifth of the full length does not reach
  // Broad at the tail's end, narrow at the tip.
  CHECK(drawing.drawn(0.0450, 0.0, 20) > drawing.drawn(0.0505, 0.0, 20));
}

TEST_CASE("a frame without a pose says why instead of showing one") {
  Drawing drawing;
  drawing.annotation.task = "square";
  drawing.annotation.time_s = 12.5;
  drawing.annotation.error_m = 0.8e-3;
  drawing.draw();
  const cv::Mat plain = drawing.image.clone();
  drawing.annotation.no_pose_reason = "two needles";
  drawing.draw();
  cv::Mat difference;
  cv::absdiff(plain, drawing.image, difference);
  CHECK(cv::countNonZero(difference.reshape(1)) > 500);
  const cv::Mat again = drawing.image.clone();
  drawing.annotation.pose = geometry::Pose2{};
  drawing.draw();  // with a pose the reason is gone
  CHECK(cv::norm(drawing.image.rowRange(45, 90), plain.rowRange(45, 90), cv::NORM_INF) == 0.0);
}

TEST_CASE("annotations at the edge, beyond it, not finite or too long are no fault") {
  for (const int scale : {1, 8}) {
    Drawing drawing(scale);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    drawing.annotation.pose = geometry::Pose2{nan, 0.0, 0.0};
    drawing.annotation.target_m = geometry::Vector2(5.0, -5.0);
    drawing.annotation.travelled_m = {{{nan, nan}, {0.0, 0.0}}, {}, {{0.2, 0.2}, {-0.2, 0.1}}};
    drawing.annotation.coil_current_A = {nan, 1e9, -1e9, 0.0};
    drawing.annotation.task = std::string(300, 'x');
    drawing.annotation.error_m = nan;
    CHECK_NOTHROW(drawing.draw());
  }
  Drawing drawing;
  cv::Mat small(10, 10, CV_8UC3);
  CHECK_THROWS_AS(imaging::annotate(small, drawing.camera, drawing.annotation), common::LogicFault);
  cv::Mat grey(1024, 1280, CV_8UC1);
  CHECK_THROWS_AS(imaging::annotate(grey, drawing.camera, drawing.annotation), common::LogicFault);
}
