#include "lodestone/console/rate_limit.h"

#include <catch2/catch.hpp>

using lodestone::console::RateLimit;

TEST_CASE("a burst may come at once, and then so many a second") {
  RateLimit limit(10.0, 5.0);
  for (int i = 0; i < 5; ++i) CHECK(limit.take(100.0));
  CHECK_FALSE(limit.take(100.0));
  CHECK_FALSE(limit.take(100.05));
  CHECK(limit.take(100.15));
  CHECK_FALSE(limit.take(100.15));
  int taken = 0;
  for (int i = 0; i < 1000; ++i) taken += limit.take(101.0 + i * 0.01) ? 1 : 0;
  CHECK(taken >= 100);
  CHECK(taken <= 106);
}
