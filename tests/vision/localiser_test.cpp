#include "lodestone/vision/localiser.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/imaging/scene_renderer.h"
#include "paper_scenes.h"

using namespace lodestone;

namespace {

std::shared_ptr<const vision::Segmenter> shipped_segmenter() {
  static const auto segmenter =
      vision::Segmenter::load(std::string(LODESTONE_SOURCE_DIR) + "/models/segmenter");
  return segmenter;
}

vision::LocaliserConfig paper_localiser() {
  vision::LocaliserConfig config;
  config.rod = vision::rod_of(tests::paper_bench());
  return config;
}

/// A scene and a localiser that knows its camera.
struct View {
  explicit View(std::uint64_t seed)
      : renderer(imaging::draw_scene(tests::paper_scenes(), seed)),
        localiser(shipped_segmenter(), renderer.scene().camera, renderer.scene().bench.dish_radius_m,
                  paper_localiser()),
        random(seed, "frames") {}

  cv::Mat image(const std::vector<imaging::NeedleView>& needles) {
    return renderer.render(needles, random).image;
  }

  imaging::SceneRenderer renderer;
  vision::Localiser localiser;
  common::RandomStream random;
};

void check_pose_near(const vision::Localisation& found, const geometry::Pose2& pose, double bound_m) {
  CAPTURE(found.reason);
  REQUIRE(found.found);
  CHECK((found.pose.position_m() - pose.position_m()).norm() < bound_m);
  CHECK(std::abs(geometry::wrap_angle(found.pose.heading_rad - pose.heading_rad)) < 0.03);
}

}  // namespace

TEST_CASE("a needle is found over the whole dish, then near its last place") {
  View view(1);
  geometry::Pose2 pose{-0.02, 0.012, 0.4};
  const vision::Localisation first = view.localiser.locate(view.image({{pose}}));
  check_pose_near(first, pose, 0.6e-3);
  CHECK_FALSE(first.tracked);
  pose = {-0.015, 0.008, 1.0};
  const vision::Localisation second = view.localiser.locate(view.image({{pose}}));
  check_pose_near(second, pose, 0.6e-3);
  CHECK(second.tracked);
}

TEST_CASE("a needle that jumped is found again over the whole dish") {
  View view(2);
  view.localiser.expect({-0.03, -0.02});
  const geometry::Pose2 pose{0.022, 0.015, 2.8};
  const vision::Localisation found = view.localiser.locate(view.image({{pose}}));
  check_pose_near(found, pose, 0.6e-3);
  CHECK_FALSE(found.tracked);
}

TEST_CASE("a needle under a stain is found a little less well, and says so") {
  View view(3);
  const geometry::Pose2 pose{0.005, -0.01, -2.0};
  const vision::Localisation found = view.localiser.locate(view.image({{pose, {0.0, 0.0}, 0.25}}));
  check_pose_near(found, pose, 1.5e-3);
  CHECK(found.covariance(0, 0) > 0.0);
}

TEST_CASE("no pose, and a reason, for no needle and for two") {
  View view(1);
  const vision::Localisation none = view.localiser.locate(view.image({}));
  CHECK_FALSE(none.found);
  CHECK_THAT(none.reason, Catch::Contains("no needle"));
  const vision::Localisation two =
      view.localiser.locate(view.image({{{-0.02, 0.01, 0.3}}, {{0.015, -0.012, 1.9}}}));
  CHECK_FALSE(two.found);
  CHECK_THAT(two.reason, Catch::Contains("more than one needle"));
}

TEST_CASE("a needle at the image's edge gives no pose") {
  // A camera so far off that its image ends within the dish.
  imaging::Scene scene = imaging::draw_scene(tests::paper_scenes(), 1);
  scene.camera = imaging::moved({}, {0.0, 0.0, 0.0}, {0.035, 0.0, 0.0});
  const imaging::SceneRenderer renderer(scene);
  vision::Localiser localiser(shipped_segmenter(), scene.camera, scene.bench.dish_radius_m,
                              paper_localiser());
  common::RandomStream random(1, "frames");
  const double edge_m = scene.camera.to_dish({0.0, 511.5}).x();
  const vision::Localisation found =
      localiser.locate(renderer.render({{{edge_m + 0.004, 0.0, 0.1}}}, random).image);
  CHECK_FALSE(found.found);
  CHECK_FALSE(found.reason.empty());
}

TEST_CASE("an image of another size is refused") {
  View view(1);
  CHECK_THROWS_AS(view.localiser.locate(cv::Mat::zeros(480, 640, CV_8UC3)), common::DataError);
}
