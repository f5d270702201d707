#include "lodestone/experiments/heading_need.h"

#include <catch2/catch.hpp>

#include "paper_rig.h"
#include "sphere_rig.h"

using namespace lodestone;

TEST_CASE("what goes by a heading is refused for a sphere, and for nothing else") {
  const physics::RigDescription needle = tests::paper_rig(), sphere = tests::sphere_rig();
  inference::Policy policy;
  policy.encoder.heading = task::HeadingEncoding::kAngle;
  CHECK_NOTHROW(experiments::refuse_heading(needle, policy, "a/policy"));
  CHECK_THROWS_WITH(experiments::refuse_heading(sphere, policy, "a/policy"),
                    Catch::StartsWith("a/policy: the policy goes by a heading"));
  policy.encoder.heading = task::HeadingEncoding::kNone;
  CHECK_NOTHROW(experiments::refuse_heading(sphere, policy, "a/policy"));
  policy.encoder.target_heading = true;
  CHECK_THROWS_WITH(experiments::refuse_heading(sphere, policy, "a/policy"),
                    Catch::Contains("rig.needle.shape"));

  inference::DynamicsModel model;
  model.info.layout = data::StateLayout::kPose;
  CHECK_NOTHROW(experiments::refuse_heading(needle, model, "a/simulator"));
  CHECK_THROWS_WITH(experiments::refuse_heading(sphere, model, "a/simulator"),
                    Catch::StartsWith("a/simulator: the simulator's states have a heading"));
  model.info.layout = data::StateLayout::kPosition;
  CHECK_NOTHROW(experiments::refuse_heading(sphere, model, "a/simulator"));

  CHECK_NOTHROW(experiments::refuse_heading(needle, "pose"));
  CHECK_NOTHROW(experiments::refuse_heading(sphere, "point"));
  CHECK_THROWS_WITH(experiments::refuse_heading(sphere, "pose"), Catch::StartsWith("task = \"pose\""));
  CHECK_NOTHROW(experiments::refuse_heading(needle, "suture"));
  CHECK_THROWS_WITH(experiments::refuse_heading(sphere, "suture"), Catch::StartsWith("task = \"suture\""));
}
