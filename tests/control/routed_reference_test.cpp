#include "lodestone/control/routed_reference.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/control/suture_reference.h"

using namespace lodestone;
using control::RoutedReference;
using geometry::Vector2;

namespace {

const Vector2 kStart(-0.025, 0.0);
const Vector2 kGoal(0.025, 0.0);

/// A disc of 4 mm in the middle, a needle of 10 mm by 1 mm, and a margin of 1 mm.
geometry::KeepOut disc_between() { return {{{"disc", {0.0, 0.0}, 0.004}}, 0.01, 0.001, 0.001}; }

struct Way {
  Way()
      : map(std::make_shared<const task::RouteMap>(task::Region::disc(0.035, 0.004),
                                                   std::vector<task::Move>(), task::RouteConfig())),
        reference(std::make_shared<control::PointReference>(kGoal, 60.0, 0.5), map, disc_between(), 0.004) {
    reference.reset();
  }
  Vector2 target(double time_s, const Vector2& position_m) {
    return reference.target(time_s, {position_m.x(), position_m.y(), 0.0});
  }
  std::shared_ptr<const task::RouteMap> map;
  RoutedReference reference;
};

/// A needle that goes 3 mm towards its target at every step.
Vector2 stepped(const Vector2& position_m, const Vector2& target_m) {
  const Vector2 to_m = target_m - position_m;
  return position_m + std::min(1.0, 0.003 / std::max(1e-9, to_m.norm())) * to_m;
}

}  // namespace

TEST_CASE("a needle that follows its targets is led around a zone to its goal, and turned only there") {
  Way way;
  const geometry::KeepOut keep_out = disc_between();
  Vector2 position_m = kStart;
  int steps = 0;
  for (; steps < 60 && (position_m - kGoal).norm() > 1e-6; ++steps) {
    const Vector2 target_m = way.target(0.3 * steps, position_m);
    CHECK(way.reference.target_heading_rad().has_value() == (target_m == kGoal));
    if (steps == 0) CHECK_FALSE(target_m == kGoal);
    position_m = stepped(position_m, target_m);
    REQUIRE(keep_out.clearance_m(position_m, position_m) > keep_out.margin_m);
  }
  CHECK(steps < 40);
  CHECK(way.reference.target_heading_rad() == 0.5);
  CHECK_FALSE(way.reference.finished(59.9));
  CHECK(way.reference.finished(60.0));
}

TEST_CASE("a needle is waited for at its goal, not on the way there") {
  Way way;
  RoutedReference reference(std::make_shared<control::SutureReference>(
                                std::vector<geometry::Stitch>{
                                    {{0.025, 0.0, 0.5 * geometry::kPi}, {0.025, 0.006, 0.5 * geometry::kPi}}},
                                control::SutureReferenceConfig()),
                            way.map, disc_between(), 0.004);
  reference.reset();
  reference.target(0.0, {kStart.x(), kStart.y(), 0.0});
  CHECK_FALSE(reference.awaits());
  reference.move_zones({});
  reference.target(0.3, {kStart.x(), kStart.y(), 0.0});
  CHECK(reference.awaits());
}

TEST_CASE("without anything in the way the needle is sent to its goal at once") {
  Way way;
  way.reference.move_zones({});
  CHECK(way.target(0.0, kStart) == kGoal);
}

TEST_CASE("when zones move the way is searched anew, and where there is none it says so") {
  Way way;
  way.target(0.0, kStart);
  const std::vector<Vector2> before = way.reference.route_m();
  const bool above = before[before.size() / 2].y() > 0.0;
  // From the middle to the wall on the side that it went.
  way.reference.move_zones({{"wall", {0.0, 0.0, 0.0, above ? 0.05 : -0.05}, 0.002}});
  way.target(0.3, kStart);
  const std::vector<Vector2> after = way.reference.route_m();
  CHECK((after[after.size() / 2].y() > 0.0) != above);
  way.reference.move_zones({{"wall", {0.0, -0.05, 0.0, 0.05}, 0.002}});
  CHECK_THROWS_AS(way.target(0.6, kStart), common::DataError);
  CHECK_THROWS_WITH(way.target(0.9, kStart), Catch::Contains("no way leads from (-25.0, 0.0) mm"));
}

TEST_CASE("a needle that lies in a zone is led out of it, not through it") {
  Way way;
  const Vector2 inside(-0.003, 0.0);
  const Vector2 target_m = way.target(0.0, inside);
  CHECK_FALSE(target_m == kGoal);
  const geometry::KeepOut keep_out = disc_between();
  CHECK(keep_out.clearance_m(target_m, target_m) > keep_out.margin_m);
}

TEST_CASE("a needle that strays gets a way from where it is") {
  Way way;
  way.target(0.0, kStart);
  CHECK(way.reference.route_m().front() == kStart);
  const Vector2 near_by = kStart + Vector2(0.0, 0.002);
  way.target(0.3, near_by);
  CHECK(way.reference.route_m().front() == kStart);
  const Vector2 elsewhere(-0.012, -0.030);
  way.target(0.6, elsewhere);
  CHECK(way.reference.route_m().front() == elsewhere);
  way.reference.reset();
  CHECK(way.reference.route_m().empty());
}
