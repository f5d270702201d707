#include "lodestone/imaging/rim_watch.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "lodestone/common/config.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/imaging/calibration.h"
#include "lodestone/imaging/scene_renderer.h"
#include "lodestone/rig/rig_config.h"
#include "paper_scenes.h"

using namespace lodestone;

namespace {

cv::Mat rendered(const imaging::SceneRenderer& renderer, std::uint64_t noise,
                 const geometry::Pose2& pose = {0.01, -0.02, 0.5}) {
  common::RandomStream random(noise, "image");
  return renderer.render({{pose}}, random).image;
}

/// A dish of 34 mm in a holder whose sides have bores of few pixels, in an image that shows little else.
imaging::SceneConfig small_dish() {
  const std::string file = LODESTONE_SOURCE_DIR "/configs/rigs/octomag.json";
  imaging::SceneConfig config;
  config.bench = rig::bench_of(common::config_from_json<rig::RigConfig>(common::read_json_file(file), file));
  config.lens.width_px = config.lens.height_px = 640;
  return config;
}

/// The needle with both ends at the wall.
geometry::Pose2 at_wall(const imaging::BenchGeometry& bench, double angle_rad) {
  const double away_m = std::sqrt(std::pow(bench.dish_radius_m, 2) -
                                  std::pow(0.5 * bench.needle_length_m + bench.needle_diameter_m, 2));
  return {away_m * std::cos(angle_rad), away_m * std::sin(angle_rad), angle_rad + 0.5 * geometry::kPi};
}

imaging::Calibration calibrated_as(const imaging::Scene& scene) {
  imaging::Calibration calibration;
  calibration.camera = scene.camera;
  return calibration;
}

/// A bench as it is drawn and calibrated, and what its camera sees once it has slipped.
struct Slipping {
  explicit Slipping(std::uint64_t seed) : scene(imaging::draw_scene(config, seed)) {
    common::RandomStream random(1, "empty");
    const imaging::SceneRenderer renderer(scene);
    calibration =
        imaging::calibrate_from_dish({renderer.render({}, random).image}, config.bench, config.lens);
  }
  /// What the watch says, and what is true.
  std::pair<std::optional<double>, double> after(const Eigen::Vector3d& turn_rad,
                                                 const Eigen::Vector3d& shift_m) {
    imaging::RimWatch watch(calibration, config.bench);
    watch.moved_m(rendered(imaging::SceneRenderer(scene), 2));
    imaging::Scene slipped = scene;
    slipped.camera = imaging::moved(scene.camera, turn_rad, shift_m);
    return {watch.moved_m(rendered(imaging::SceneRenderer(slipped), 3)),
            imaging::floor_error(slipped.camera, scene.camera, config.bench).rms_m};
  }

  imaging::SceneConfig config = tests::paper_scenes();
  imaging::Scene scene;
  imaging::Calibration calibration;
};

}  // namespace

TEST_CASE("a camera that stands still is not said to have moved, wherever the needle lies") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Slipping bench(seed);
    const imaging::SceneRenderer renderer(bench.scene);
    imaging::RimWatch watch(bench.calibration, bench.config.bench);
    for (int i = 0; i < 4; ++i) {
      const auto moved_m = watch.moved_m(
          rendered(renderer, 10 + static_cast<std::uint64_t>(i), {-0.03 + 0.02 * i, -0.02, 0.5}));
      CAPTURE(seed, i);
      REQUIRE(moved_m);
      CHECK(*moved_m < 0.1e-3);
    }
  }
}

TEST_CASE(
    "a camera over a small dish that stands still is not said to have moved, whatever lies in the dish") {
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    imaging::SceneConfig config = small_dish();
    if (seed % 2 == 0) {  // with a thick and tall wall
      config.bench.wall_thickness_m = 0.003;
      config.bench.wall_height_m = 0.006;
    }
    const imaging::Scene scene = imaging::draw_scene(config, seed);
    const imaging::SceneRenderer renderer(scene);
    imaging::RimWatch watch(calibrated_as(scene), config.bench);
    for (int i = 0; i < 3; ++i) {
      const geometry::Pose2 pose = at_wall(config.bench, 2.0 * i + 0.3 * static_cast<double>(seed));
      const auto moved_m = watch.moved_m(rendered(renderer, 10 + static_cast<std::uint64_t>(i), pose));
      CAPTURE(seed, i);
      REQUIRE(moved_m);
      CHECK(*moved_m < 0.1e-3);
    }
  }
}

TEST_CASE("a slip of 0.4 mm is found out over a small dish as over the paper's") {
  for (const imaging::SceneConfig& config : {tests::paper_scenes(), small_dish()}) {
    for (const std::uint64_t seed : {1, 2}) {
      imaging::Scene scene = imaging::draw_scene(config, seed);
      const double way_rad = 2.0 * static_cast<double>(seed);
      const geometry::Pose2 pose = at_wall(config.bench, way_rad);
      imaging::RimWatch watch(calibrated_as(scene), config.bench);
      watch.moved_m(rendered(imaging::SceneRenderer(scene), 2, pose));
      scene.camera = imaging::moved(scene.camera, Eigen::Vector3d::Zero(),
                                    {0.4e-3 * std::cos(way_rad), 0.4e-3 * std::sin(way_rad), 0.0});
      const auto moved_m = watch.moved_m(rendered(imaging::SceneRenderer(scene), 3, pose));
      CAPTURE(config.bench.dish_radius_m, seed);
      REQUIRE(moved_m);
      CHECK(*moved_m > imaging::CalibrationConfig{}.moved_bound_m);
      CHECK(*moved_m == Approx(0.4e-3).margin(0.05e-3));
    }
  }
}

TEST_CASE("a camera that has slipped is found out, and by how much") {
  Slipping bench(5);
  for (const Eigen::Vector3d& shift_m : {Eigen::Vector3d(4e-4, 0.0, 0.0), Eigen::Vector3d(0.0, -6e-4, 0.0),
                                         Eigen::Vector3d(5e-4, 5e-4, 0.0)}) {
    const auto [said_m, true_m] = bench.after(Eigen::Vector3d::Zero(), shift_m);
    REQUIRE(said_m);
    CHECK(*said_m == Approx(true_m).margin(0.1e-3));
  }
  const auto [turned_m, truly_m] =
      bench.after({0.0, 0.0, 0.02}, Eigen::Vector3d::Zero());  // about its own axis
  REQUIRE(turned_m);
  CHECK(*turned_m > 0.3e-3);
  CHECK(*turned_m == Approx(truly_m).epsilon(0.4));
}

TEST_CASE("where the rim is covered, or far from its place, nothing is said") {
  Slipping bench(6);
  imaging::RimWatch watch(bench.calibration, bench.config.bench);
  const imaging::SceneRenderer renderer(bench.scene);
  cv::Mat covered = rendered(renderer, 3).clone();
  REQUIRE(watch.moved_m(rendered(renderer, 2)));
  covered.setTo(cv::Scalar(90, 120, 180));
  CHECK_FALSE(watch.moved_m(covered));
  // A hand over a third of it is looked past.
  cv::Mat hand = rendered(renderer, 4).clone();
  hand(cv::Rect(0, 0, hand.cols / 3, hand.rows)).setTo(cv::Scalar(90, 120, 180));
  const auto beside_m = watch.moved_m(hand);
  REQUIRE(beside_m);
  CHECK(*beside_m < 0.15e-3);
  CHECK_FALSE(bench.after(Eigen::Vector3d::Zero(), {8e-3, 0.0, 0.0}).first);
}
