#include "lodestone/safety/deadline_check.h"

#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("missed deadlines in a row are not trusted, single ones are") {
  safety::DeadlineCheck check(0.1, 3);
  for (int i = 0; i < 5; ++i) {
    check.begin_step(1.2, 1.0);
    check.begin_step(1.2, 1.0);
    check.begin_step(1.05, 1.0);
  }
  check.begin_step(1.2, 1.0);
  check.begin_step(1.2, 1.0);
  CHECK_THROWS_WITH(check.begin_step(1.25, 1.0),
                    Catch::Contains("3 steps in a row began late, the last by 0.25 s"));
}
