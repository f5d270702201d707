#include "dish_edges.h"

#include <catch2/catch.hpp>

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
