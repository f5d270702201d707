#include "lodestone/env/joined_env.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "env/linear_model.h"
#include "env/sample_settings.h"
#include "env/vec_env_conformance.h"
#include "lodestone/common/error.h"
#include "lodestone/env/mbs_env.h"
#include "lodestone/env/replay_env.h"

namespace lodestone::env {
namespace {

TEST_CASE("joined environments are their parts, one after the other, and resume bitwise", "[unit]") {
  const inference::DynamicsModel model = tests::linear_model(data::StateLayout::kPose, {1e-3}, {0.0});
  const auto make = [&] {
    std::vector<std::unique_ptr<VecEnv>> parts;
    parts.push_back(std::make_unique<MbsEnv>(model, tests::plain_settings(3), MbsConfig(), 1));
    parts.push_back(
        std::make_unique<ReplayEnv>(tests::recording(), tests::plain_settings(2), ReplayConfig()));
    return JoinedEnv(std::move(parts));
  };
  JoinedEnv joined = make();
  JoinedEnv other = make();
  CHECK(joined.spec().count == 5);
  joined.reset();
  for (std::uint64_t step = 0; step < 7; ++step) joined.step(tests::random_actions(joined.spec(), step));
  other.load(joined.save());
  for (std::uint64_t step = 7; step < 40; ++step) {
    const std::vector<float> actions = tests::random_actions(joined.spec(), step);
    const StepResult& result = joined.step(actions);
    REQUIRE(tests::same(result, other.step(actions)));
    CHECK(std::equal(actions.begin(), actions.begin() + 6, result.action.begin()));
    CHECK_FALSE(std::equal(actions.begin() + 6, actions.end(), result.action.begin() + 6));
    CHECK(result.penalty.size() == 5);
    CHECK(result.progress.size() == 5);
  }
  CHECK_THROWS_AS(other.load({}), common::CheckpointError);
}

TEST_CASE("parts of other sizes, and no part, are refused", "[unit]") {
  CHECK_THROWS_AS(JoinedEnv({}), common::LogicFault);
  EpisodeSettings wide = tests::plain_settings(2);
  wide.encoder.heading = task::HeadingEncoding::kAngle;
  std::vector<std::unique_ptr<VecEnv>> parts;
  parts.push_back(std::make_unique<ReplayEnv>(tests::recording(), tests::plain_settings(2), ReplayConfig()));
  parts.push_back(std::make_unique<ReplayEnv>(tests::recording(), wide, ReplayConfig()));
  CHECK_THROWS_AS(JoinedEnv(std::move(parts)), common::LogicFault);
}

}  // namespace
}  // namespace lodestone::env
