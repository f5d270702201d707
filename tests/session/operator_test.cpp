#include "lodestone/session/operator.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "session/operator_conformance.h"

using namespace lodestone;

TEST_CASE("the fake operator, and one who is asked, keep the contract of Operator") {
  tests::FakeOperator fake;
  tests::check_operator(
      fake, [&] { return fake.placed; }, 0.0);
  geometry::Pose2 lies_at;
  session::AskedOperator asked([&](const geometry::Pose2& pose) { lies_at = pose; });
  tests::check_operator(
      asked, [&] { return lies_at; }, 0.0);
}

TEST_CASE("where nobody can place the needle, that is said") {
  session::AbsentOperator nobody;
  CHECK_THROWS_WITH(nobody.place({}), Catch::Contains("nobody can be asked"));
}
