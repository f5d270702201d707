#include "dish_edges.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "paper_scenes.h"

using namespace lodestone;
using namespace lodestone::imaging;

TEST_CASE(
    "the edges of a bench are its circles and its coils' base lines, with tangents across their normals") {
  const BenchGeometry bench = tests::paper_bench();
  const auto edges = edges_of(bench, 24, 10);
  CHECK(edges.size() == 3 * 24 + 4 * 10);
  for (const EdgePoint& edge : edges) {
    CAPTURE(name_of(edge.kind));
    CHECK(edge.along.norm() == Approx(1.0));
    CHECK(std::abs(edge.along.dot(edge.outward)) < 1e-12);
    CHECK((edge.part >= 0 && edge.part < kParts));
    const double radius_m = edge.point_m.head<2>().norm();
    if (edge.kind == kFloor) CHECK(radius_m == Approx(bench.dish_radius_m));
    if (!is_circle(edge.kind)) CHECK(radius_m > bench.dish_radius_m);
  }
}

TEST_CASE("an edge point is seen where the camera projects it, unless it is out of view") {
  const BenchGeometry bench = tests::paper_bench();
  const CameraModel camera = nominal_camera(LensConfig{});
  const EdgePoint edge = edges_of(bench, 24, 10).front();
  const SeenEdge seen = see(camera, edge);
  CHECK((camera.to_dish(seen.pixel) - edge.point_m.head<2>()).norm() < 1e-9);
  CHECK(seen.normal.norm() == Approx(1.0));
  const Visibility visible(camera, bench);
  CHECK_FALSE(visible(edge, {-5.0, 300.0}, 3.0));
  CHECK_FALSE(visible(edge, {300.0, 5000.0}, 3.0));
}

TEST_CASE("beside an edge there is room up to the next: the wall's other edge, a bore's upper end, the rim") {
  const BenchGeometry bench = tests::paper_bench();
  const CameraModel camera =
      moved(nominal_camera(LensConfig{}), Eigen::Vector3d::Zero(), Eigen::Vector3d(0.03, 0.0, 0.0));
  const Visibility visible(camera, bench);
  for (const EdgePoint& edge : edges_of(bench, 24, 10)) {
    CAPTURE(name_of(edge.kind));
    const double room_px = visible.room_px(edge);
    if (is_circle(edge.kind)) {
      CHECK(room_px == Approx(bench.wall_thickness_m / camera.pixel_size_m()));
      continue;
    }
    const double aside_m = edge.point_m.dot(edge.along);
    const double height_m = std::sqrt(std::pow(bench.coil_bore_radius_m, 2) - std::pow(aside_m, 2));
    const Eigen::Vector3d end_m = edge.point_m + Eigen::Vector3d(0.0, 0.0, height_m);
    const SeenEdge seen = see(camera, edge);
    const double strip_px = (camera.project(end_m) - seen.pixel).dot(seen.normal);
    CHECK(room_px < strip_px + 1e-6);
    if (edge.kind == kCoilPlusX) CHECK(room_px == Approx(strip_px));  // which the camera is nearest to
  }
  BenchGeometry thick = bench;
  thick.wall_thickness_m = 0.01;
  const Visibility over_wall(camera, thick);
  for (const EdgePoint& edge : edges_of(thick, 24, 1))
    if (!is_circle(edge.kind)) CHECK(over_wall.room_px(edge) < 0.0);
}

TEST_CASE("an edge is looked for no further than where the next one is clear of it") {
  CHECK(reach_within_px(15.0, 10.0) == 10.0);
  CHECK(reach_within_px(10.0, 10.0) == 6.0);
  CHECK(reach_within_px(4.0, 10.0) == 3.0);
}

TEST_CASE("an edge of an image is found to a fraction of a pixel, with its sign") {
  cv::Mat_<float> image(60, 60);
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 60; ++u)
      image(v, u) = std::clamp(10.0F * (static_cast<float>(u) - 31.3F), 0.0F, 80.0F);
  CHECK(sample(image, 33.5, 20.0) == Approx(22.0).margin(0.01));
  const SeenEdge predicted{{33.0, 30.0}, {1.0, 0.0}};
  const EdgeHit hit = find_edge(image, predicted, 10.0, 1.0, 2.0);
  REQUIRE(hit.found);
  CHECK(hit.offset_px == Approx(31.3 + 4.0 - 33.0).margin(1.5));
  CHECK(hit.contrast > 5.0);
  CHECK_FALSE(find_edge(image, predicted, 10.0, -1.0, 2.0).found);
  CHECK_FALSE(find_edge(image, {{12.0, 30.0}, {1.0, 0.0}}, 8.0, 1.0, 2.0).found);
}
