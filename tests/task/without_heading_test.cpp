#include "lodestone/task/without_heading.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;

TEST_CASE("without a heading a policy sees none, and is not asked to have one") {
  task::TaskConfig rules;
  task::EncoderConfig encoder;
  encoder.heading = task::HeadingEncoding::kSineCosine;
  encoder.target_heading = true;
  task::leave_out_heading(rules, encoder, "a sphere");
  CHECK(encoder.heading == task::HeadingEncoding::kNone);
  CHECK_FALSE(encoder.target_heading);
  encoder.target = true;
  encoder.relative_target = false;
  CHECK(task::ObservationEncoder(encoder).size() == 4);  // where it is, and where it should be

  rules.goal = task::GoalKind::kPose;
  CHECK_THROWS_WITH(task::leave_out_heading(rules, encoder, "a sphere"),
                    Catch::Contains("task.goal = \"pose\", but a sphere has no heading"));
}
