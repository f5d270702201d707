#include "lodestone/physics/body_motion.h"

#include <catch2/catch.hpp>

#include "lodestone/physics/field_table.h"
#include "sphere_rig.h"

namespace lodestone::physics {
namespace {

TEST_CASE("what lies in the dish moves by its shape") {
  const CoilArray coils(make_field_table(CoilGeometry{}, 0.0425));
  const FrictionMap map(FrictionConfig{}, 0.0425, 1);
  const PerCoil current{10.0, 0.0, 4.0, 0.0};
  const RigDescription rig;
  const BodyMotion body(rig);
  const NeedleMotion needle(rig.needle, rig.fluid, rig.friction, rig.dish);
  NeedleState of_body, of_needle;
  for (int i = 0; i < 100; ++i) {
    body.step(of_body, coils, current, map, 1.0, 0.5e-3);
    needle.step(of_needle, coils, current, map, 1.0, 0.5e-3);
  }
  CHECK(of_body.pose.x_m == of_needle.pose.x_m);
  CHECK(of_body.pose.heading_rad == of_needle.pose.heading_rad);
  CHECK(of_body.pose.heading_rad != 0.0);

  const RigDescription round = tests::sphere_rig();
  const BodyMotion ball(round);
  NeedleState of_ball;
  for (int i = 0; i < 100; ++i) ball.step(of_ball, coils, current, map, 1.0, 0.5e-3);
  CHECK(of_ball.pose.x_m > 1e-4);
  CHECK(of_ball.pose.heading_rad == 0.0);
  // A needle has to lie along the wall there.
  CHECK(ball.fits({0.04, 0.0, 0.0}));
  CHECK_FALSE(body.fits({0.04, 0.0, 0.0}));
}

TEST_CASE("obstacles and moving fluid are the needle's") {
  ObstacleConfig post;
  post.radius_m = 4e-3;
  FlowConfig uniform;
  uniform.kind = FlowKind::kUniform;
  uniform.speed_m_s = 0.01;
  const RigDescription rig;
  const BodyMotion body(rig, Flow(uniform), Obstacles({post}));
  CHECK(body.fluid_moves());
  CHECK(body.fits({}));
  CHECK_FALSE(body.free_at({}));
  const auto beside = body.free_near({});
  REQUIRE(beside);
  CHECK(body.free_at(*beside));
  const BodyMotion ball(tests::sphere_rig());
  CHECK_FALSE(ball.fluid_moves());
  CHECK(ball.free_at({}));
  CHECK(ball.free_near({}));
  CHECK_FALSE(ball.free_near({0.05, 0.0, 0.0}));
}

}  // namespace
}  // namespace lodestone::physics
