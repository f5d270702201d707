#include "lodestone/experiments/speed_limit.h"

#include <catch2/catch.hpp>

using lodestone::control::ControlLoopConfig;
using lodestone::experiments::square_speed_limit_m_s;
using lodestone::physics::RigDescription;

TEST_CASE("physics carries a needle as fast as its weakest place on a square allows") {
  const RigDescription paper;
  const ControlLoopConfig loop;
  constexpr double kSide_m = 0.03;
  const double limit_m_s = square_speed_limit_m_s(paper, kSide_m, loop);
  CHECK(limit_m_s > 0.006);  // the fastest square of `bench tasks`
  CHECK(limit_m_s < 2.0 * paper.dish.radius_m / loop.period_s());
  // Less often is slower, less pull is slower, and what friction holds does not move.
  ControlLoopConfig rarely = loop;
  rarely.rest_s += loop.period_s();
  CHECK(square_speed_limit_m_s(paper, kSide_m, rarely) == Approx(0.5 * limit_m_s).epsilon(0.05));
  RigDescription weaker = paper;
  weaker.coils.max_current_A *= 0.35;
  const double weaker_m_s = square_speed_limit_m_s(weaker, kSide_m, loop);
  CHECK(weaker_m_s > 0.0);
  CHECK(weaker_m_s < 0.8 * limit_m_s);
  weaker.coils.max_current_A = 0.01;
  CHECK(square_speed_limit_m_s(weaker, kSide_m, loop) == 0.0);
}
