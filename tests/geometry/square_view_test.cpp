#include "lodestone/geometry/square_view.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <vector>

#include "lodestone/geometry/angle.h"

using namespace lodestone;
using geometry::kPi;
using geometry::SquareView;

TEST_CASE("every place is seen in the same eighth, and left where it was") {
  for (int i = 0; i < 360; ++i) {
    const double angle_rad = (i + 0.25) * kPi / 180.0;
    const double x = 0.02 * std::cos(angle_rad), y = 0.02 * std::sin(angle_rad);
    CAPTURE(i);
    const SquareView view = SquareView::of(x, y);
    double place[2] = {x, y};
    view.enter(place);
    CHECK(place[1] >= 0.0);
    CHECK(place[1] <= place[0]);
    CHECK(std::hypot(place[0], place[1]) == Approx(0.02));
    view.leave(place);
    CHECK(place[0] == x);
    CHECK(place[1] == y);
  }
}

TEST_CASE("headings are seen as the vectors along them are") {
  for (int i = 0; i < 8; ++i) {
    const double angle_rad = (45.0 * i + 10.0) * kPi / 180.0;
    const SquareView view = SquareView::of(std::cos(angle_rad), std::sin(angle_rad));
    CHECK(view.swaps_axes() == (i == 1 || i == 2 || i == 5 || i == 6));
    for (const double heading_rad : {-3.0, -1.2, 0.3, 2.9}) {
      double along[2] = {std::cos(heading_rad), std::sin(heading_rad)};
      view.enter(along);
      const double seen_rad = view.entered_rad(heading_rad);
      CHECK(std::cos(seen_rad) == Approx(along[0]).margin(1e-12));
      CHECK(std::sin(seen_rad) == Approx(along[1]).margin(1e-12));
      CHECK(view.left_rad(seen_rad) == Approx(heading_rad));
    }
  }
}

TEST_CASE("each of the eight views tells that it is that one") {
  std::set<std::vector<float>> told;
  for (int i = 0; i < 8; ++i) {
    const double angle_rad = (45.0 * i + 10.0) * kPi / 180.0;
    const SquareView view = SquareView::of(std::cos(angle_rad), std::sin(angle_rad));
    std::vector<float> way(SquareView::kViewNumbers);
    view.write_view(way.data());
    CAPTURE(i);
    double east[2] = {1.0, 0.0};
    view.leave(east);
    CHECK(static_cast<double>(way[0]) == east[0]);
    CHECK(static_cast<double>(way[1]) == east[1]);
    CHECK(way[2] == (i % 2 == 0 ? 1.0F : -1.0F));
    told.insert(way);
  }
  CHECK(told.size() == 8);
}

TEST_CASE("places on the edges of the eighths are seen in it, too") {
  const double edges[][2] = {{0.0, 0.0},  {1.0, 0.0},   {1.0, 1.0},  {0.0, 1.0}, {-1.0, 1.0},
                             {-1.0, 0.0}, {-1.0, -1.0}, {0.0, -1.0}, {1.0, -1.0}};
  for (const auto& edge : edges) {
    CAPTURE(edge[0], edge[1]);
    double place[2] = {edge[0], edge[1]};
    SquareView::of(edge[0], edge[1]).enter(place);
    CHECK(place[1] >= 0.0);
    CHECK(place[1] <= place[0]);
  }
}
