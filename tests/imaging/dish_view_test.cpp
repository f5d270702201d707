#include "lodestone/imaging/dish_view.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/imaging/scene_renderer.h"
#include "paper_scenes.h"

using namespace lodestone;

namespace {

/// Middle of a mask in metres, by the view.
geometry::Vector2 centroid_m(const imaging::DishView& view, const cv::Mat& mask, const cv::Rect& area) {
  geometry::Vector2 sum = geometry::Vector2::Zero();
  double weight = 0.0;
  for (int row = 0; row < mask.rows; ++row) {
    for (int column = 0; column < mask.cols; ++column) {
      sum += mask.at<unsigned char>(row, column) * view.to_dish(area.x + column, area.y + row);
      weight += mask.at<unsigned char>(row, column);
    }
  }
  return sum / weight;
}

}  // namespace

TEST_CASE("a view shows the dish straight, whole or in part, whatever the camera") {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const imaging::Scene scene = imaging::draw_scene(tests::paper_scenes(), seed);
    const imaging::SceneRenderer renderer(scene);
    const imaging::DishView view(scene.camera, 0.0425, 0.002, 0.2e-3, 32);
    CHECK(view.size_px() == 448);
    common::RandomStream random(seed, "frame");
    const geometry::Pose2 pose{0.015, -0.011, 2.0};
    const imaging::RenderedFrame frame = renderer.render({{pose}}, random, true);
    for (const cv::Rect& area : {view.whole(), view.around(pose.position_m(), 256)}) {
      const cv::Mat mask = view.cut(frame.tape_mask, area);
      const geometry::Vector2 head =
          pose.position_m() + 0.01025 * geometry::Vector2(std::cos(2.0), std::sin(2.0));
      CHECK((centroid_m(view, mask, area) - head).norm() < 0.03e-3);
    }
  }
}

TEST_CASE("areas around a point keep to the view and to the grid") {
  const imaging::DishView view({}, 0.0425, 0.002, 0.2e-3, 32);
  for (const double x : {-0.1, -0.02, 0.0, 0.013, 0.1}) {
    const cv::Rect area = view.around({x, -x}, 256);
    CHECK((area & view.whole()) == area);
    CHECK(area.x % 32 == 0);
    CHECK(area.y % 32 == 0);
  }
  CHECK(view.shows({0.04, 0.0}));
  CHECK_FALSE(view.shows({0.2, 0.0}));
}

TEST_CASE("an image of another size is refused") {
  const imaging::DishView view({}, 0.0425, 0.002, 0.2e-3, 32);
  CHECK_THROWS_AS(view.cut(cv::Mat::zeros(480, 640, CV_8UC3), view.whole()), common::DataError);
}
