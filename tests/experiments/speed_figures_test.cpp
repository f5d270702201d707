#include "speed_figures.h"

#include <catch2/catch.hpp>

#include "lodestone/common/statistics.h"

using namespace lodestone;
using namespace lodestone::experiments;

namespace {

SpeedConfig quick() {
  SpeedConfig config;
  config.run_s = 0.01;
  return config;
}

}  // namespace

TEST_CASE("the work of an update and of a step is counted by hand") {
  rl::Td3Config td3;
  td3.batch_size = 1;
  td3.hidden = {4};
  td3.policy_frequency = 1;
  // Actor 5-4-2: 56 FLOP forward; critic 7-4-1: 64. Targets, twin critics and the policy's update.
  CHECK(td3_update_flop(td3) == Approx(56.0 + 2.0 * 64.0 + 6.0 * 64.0 + 3.0 * 56.0 + 2.0 * 64.0));
  td3.batch_size = 10;
  CHECK(td3_update_flop(td3) == Approx(10.0 * 864.0));
  CHECK(mbs_step_flop() > 1000.0);
}

TEST_CASE("every rate is one, on a thread and on two", "[clock]") {
  const SpeedConfig config = quick();
  rl::Td3Config td3;
  td3.batch_size = 16;
  for (const std::int64_t threads : {1, 2}) {
    CHECK(sgemm_rate(config, threads)() > 1e6);
    CHECK(gemm_rate(config, threads)() > 1e6);
    CHECK(td3_rate(config, td3, threads)() > 1.0);
    CHECK(mbs_rate(config, 64, threads)() > 100.0);
    CHECK(rig_rate(config, threads)() > 1.0);
  }
}

TEST_CASE("every decision is timed, the planner's and the policy's") {
  SpeedConfig config = quick();
  config.images = 10;
  DecisionLatency latency(config);
  latency.measure();
  latency.measure();
  for (const std::vector<double>* times_ms : {&latency.planner_ms, &latency.policy_ms}) {
    CHECK(times_ms->size() == 20);
    CHECK(common::percentile(*times_ms, 0.0) > 0.0);
  }
  CHECK(common::median(latency.planner_ms) > common::median(latency.policy_ms));
}
