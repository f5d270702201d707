#include "lodestone/imaging/scene_renderer.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <opencv2/core.hpp>
#include <set>
#include <string>

#include "lodestone/common/error.h"
#include "paper_scenes.h"
#include "sphere_rig.h"

using namespace lodestone;

namespace {

const geometry::Pose2 kPose{0.012, -0.008, 0.6};

imaging::Scene scene_with(double noise_grey, std::uint64_t seed = 3) {
  imaging::Scene scene = imaging::draw_scene(tests::paper_scenes(), seed);
  scene.noise_grey = noise_grey;
  return scene;
}

/// Middle of a mask, on the dish floor.
geometry::Vector2 centroid_m(const cv::Mat& mask, const imaging::CameraModel& camera) {
  geometry::Vector2 sum = geometry::Vector2::Zero();
  double weight = 0.0;
  for (int v = 0; v < mask.rows; ++v) {
    for (int u = 0; u < mask.cols; ++u) {
      const int value = mask.at<unsigned char>(v, u);
      if (value == 0) continue;
      sum += value * camera.to_dish({static_cast<double>(u), static_cast<double>(v)});
      weight += value;
    }
  }
  return sum / weight;
}

}  // namespace

TEST_CASE("the masks are where the needle and its tape are") {
  const imaging::Scene scene = scene_with(2.0);
  const imaging::SceneRenderer renderer(scene);
  common::RandomStream random(1, "frame");
  const imaging::RenderedFrame frame = renderer.render({{kPose}}, random, true);
  const imaging::BenchGeometry& bench = scene.bench;
  const geometry::Vector2 forward(std::cos(kPose.heading_rad), std::sin(kPose.heading_rad));
  const double to_tape_m = 0.5 * (bench.needle_length_m - bench.tape_length_m);
  // The tape makes the head 8 % thicker, which draws the middle of the mask towards it.
  const double pull_m = 0.08 * bench.tape_length_m / bench.needle_length_m * to_tape_m;
  CHECK((centroid_m(frame.needle_mask, scene.camera) - (kPose.position_m() + pull_m * forward)).norm() <
        0.02e-3);
  const geometry::Vector2 head = kPose.position_m() + to_tape_m * forward;
  CHECK((centroid_m(frame.tape_mask, scene.camera) - head).norm() < 0.1e-3);
  const double pixel_m = scene.camera.pixel_size_m();
  const double area_m2 = cv::sum(frame.needle_mask)[0] / 255.0 * pixel_m * pixel_m;
  CHECK(area_m2 == Approx(bench.needle_length_m * bench.needle_diameter_m).epsilon(0.05));
}

TEST_CASE("a sphere is a disc of its size, without tape, whatever its heading") {
  imaging::Scene scene = scene_with(0.0);
  scene.bench = rig::bench_of(tests::sphere_rig());
  const imaging::SceneRenderer renderer(scene);
  common::RandomStream random(1, "frame");
  const imaging::RenderedFrame frame = renderer.render({{kPose}}, random, true);
  CHECK((centroid_m(frame.needle_mask, scene.camera) - kPose.position_m()).norm() < 0.02e-3);
  CHECK(cv::countNonZero(frame.tape_mask) == 0);
  const double pixel_m = scene.camera.pixel_size_m();
  const double area_m2 = cv::sum(frame.needle_mask)[0] / 255.0 * pixel_m * pixel_m;
  CHECK(area_m2 == Approx(3.14159265 * 1.5e-3 * 1.5e-3).epsilon(0.05));
  imaging::NeedleView other_way;
  other_way.pose = {kPose.x_m, kPose.y_m, kPose.heading_rad + 1.0};
  const imaging::RenderedFrame turned = renderer.render({other_way}, random, true);
  CHECK(cv::norm(frame.needle_mask, turned.needle_mask, cv::NORM_INF) <= 2.0);
  // It is darker towards its edge, and darker than the floor beside it.
  const cv::Mat nothing = renderer.render({}, random).image;
  const Eigen::Vector2d middle = scene.camera.project_floor(kPose.position_m());
  const auto grey = [&](const cv::Mat& image, double off_m) {
    const auto column = static_cast<int>(std::lround(middle.x() + off_m / pixel_m));
    const cv::Vec3b& pixel = image.at<cv::Vec3b>(static_cast<int>(std::lround(middle.y())), column);
    return static_cast<int>(pixel[0]) + pixel[1] + pixel[2];
  };
  CHECK(grey(frame.image, 0.0) > grey(frame.image, 1.2e-3));
  CHECK(grey(frame.image, 1.2e-3) < grey(nothing, 1.2e-3));
}

TEST_CASE("a frame depends on scene, needle and random stream alone") {
  const imaging::Scene scene = scene_with(2.0);
  const imaging::SceneRenderer first(scene);
  const imaging::SceneRenderer second(scene);
  common::RandomStream a(1, "frame");
  common::RandomStream b(1, "frame");
  const cv::Mat one = first.render({{kPose, {0.0, 0.0}, 0.3}}, a).image;
  CHECK(cv::norm(one, second.render({{kPose, {0.0, 0.0}, 0.3}}, b).image, cv::NORM_INF) == 0.0);
  CHECK(cv::norm(one, second.render({{kPose, {0.0, 0.0}, 0.3}}, b).image, cv::NORM_INF) > 0.0);
}

TEST_CASE("a needle that lies still is never seen twice by the very same image") {
  const imaging::SceneRenderer renderer(scene_with(4.0));
  common::RandomStream random(1, "frame");
  std::set<std::string> rows;
  constexpr std::size_t kFrames = 1000;
  for (std::size_t i = 0; i < kFrames; ++i) {
    const cv::Mat image = renderer.render({}, random).image;
    // Two rows: the noise of one alone is often enough seen again.
    rows.insert(std::string(image.ptr<char>(500), 60) + std::string(image.ptr<char>(501), 60));
  }
  CHECK(rows.size() == kFrames);
}

TEST_CASE("noise has the standard deviation it is given") {
  const imaging::SceneRenderer quiet(scene_with(0.0));
  const imaging::SceneRenderer noisy(scene_with(4.0));
  common::RandomStream random(1, "frame");
  const cv::Rect floor(500, 450, 200, 150);
  cv::Mat difference;
  cv::subtract(noisy.render({}, random).image(floor), quiet.render({}, random).image(floor), difference, {},
               CV_32F);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(difference, mean, deviation);
  CHECK(std::abs(mean[1]) < 0.2);
  CHECK(deviation[1] == Approx(4.0).epsilon(0.1));
}

TEST_CASE("a covered needle keeps its mask and loses some of its image") {
  const imaging::SceneRenderer renderer(scene_with(0.0));
  common::RandomStream random(1, "frame");
  const cv::Mat empty = renderer.render({}, random).image;
  const auto changed = [&](const cv::Mat& image, const cv::Mat& within) {
    cv::Mat difference;
    cv::absdiff(image, empty, difference);
    cv::Mat channels[3];
    cv::split(difference, channels);
    return cv::countNonZero((channels[0] + channels[1] + channels[2] > 20) & (within > 200));
  };
  const imaging::RenderedFrame bare = renderer.render({{kPose}}, random, true);
  const imaging::RenderedFrame hidden = renderer.render({{kPose, {0.0, 0.0}, 0.4}}, random, true);
  CHECK(cv::norm(bare.needle_mask, hidden.needle_mask, cv::NORM_INF) == 0.0);
  CHECK(changed(bare.image, bare.needle_mask) > 0.8 * cv::countNonZero(bare.needle_mask > 200));
  cv::Mat difference;
  cv::absdiff(bare.image, hidden.image, difference);
  CHECK(cv::countNonZero(difference.reshape(1) > 20) > 500);
}

TEST_CASE("what moves during the exposure is smeared") {
  const imaging::SceneRenderer renderer(scene_with(0.0));
  common::RandomStream random(1, "frame");
  const geometry::Pose2 across{0.0, 0.0, 0.0};
  const cv::Mat sharp = renderer.render({{across}}, random, true).needle_mask;
  const cv::Mat smeared = renderer.render({{across, {0.0, 0.002}}}, random, true).needle_mask;
  CHECK(cv::countNonZero(smeared > 10) > 2 * cv::countNonZero(sharp > 10));
  CHECK(cv::sum(smeared)[0] == Approx(cv::sum(sharp)[0]).epsilon(0.03));
}

TEST_CASE("an obstacle is in the image, and in no label") {
  imaging::Scene scene = scene_with(0.0);
  const imaging::SceneRenderer bare(scene);
  scene.bench.obstacles_m = {{{-0.02, 0.0}, {-0.01, 0.0}, {-0.01, 0.01}, {-0.02, 0.01}}};
  const imaging::SceneRenderer with_obstacle(scene);
  common::RandomStream a(1, "frame"), b(1, "frame");
  const imaging::RenderedFrame before = bare.render({{kPose}}, a, true);
  const imaging::RenderedFrame after = with_obstacle.render({{kPose}}, b, true);
  CHECK(cv::norm(before.needle_mask, after.needle_mask, cv::NORM_INF) == 0.0);
  CHECK(cv::norm(before.tape_mask, after.tape_mask, cv::NORM_INF) == 0.0);
  cv::Mat difference;
  cv::absdiff(before.image, after.image, difference);
  const double pixel_m = scene.camera.pixel_size_m();
  const double area_m2 = cv::countNonZero(difference.reshape(1) > 20) / 3.0 * pixel_m * pixel_m;
  CHECK((area_m2 > 70e-6 && area_m2 < 130e-6));
}

TEST_CASE("a needle out of the view leaves nothing") {
  const imaging::SceneRenderer renderer(scene_with(0.0));
  common::RandomStream random(1, "frame");
  CHECK(cv::countNonZero(renderer.render({{{0.2, 0.0, 0.0}}}, random, true).needle_mask) == 0);
}
