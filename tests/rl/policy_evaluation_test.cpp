#include "lodestone/rl/policy_evaluation.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/artefact.h"
#include "rl/toy_environments.h"

using namespace lodestone;
using rl::testing::PointEnv;

namespace {

task::EncoderConfig point_encoder() {
  task::EncoderConfig encoder;
  encoder.heading = task::HeadingEncoding::kNone;
  encoder.target = false;
  encoder.length_scale_m = 1.0;
  return encoder;
}

/// An actor that always gives tanh of these two numbers.
inference::Actor constant_actor(float x, float y) {
  return {
      {{"l1.weight", {std::vector<float>(4), {2, 2}}}, {"l1.bias", {std::vector<float>{x, y}, {2}}}}, 2, {}};
}

}  // namespace

TEST_CASE("Evaluation repeats itself, whatever went on in between", "[rl]") {
  PointEnv environments(50, 77);
  rl::PolicyEvaluation evaluate(environments, point_encoder());
  const rl::PolicyScore first = evaluate.run(constant_actor(0.3F, -0.1F));
  const rl::PolicyScore other = evaluate.run(constant_actor(-0.3F, 0.2F));
  const rl::PolicyScore second = evaluate.run(constant_actor(0.3F, -0.1F));
  CHECK(common::artefact_to_json(first) == common::artefact_to_json(second));
  CHECK(first.episode_return != other.episode_return);
}

TEST_CASE("The score of standing still is that of the starts", "[rl]") {
  PointEnv environments(50, 77);
  rl::PolicyEvaluation evaluate(environments, point_encoder());
  const rl::PolicyScore score = evaluate.run(constant_actor(0.0F, 0.0F));
  PointEnv same(50, 77);
  const std::vector<float> starts = same.reset();
  double error_mm = 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < 50; ++i) {
    error_mm += 1e3 * std::hypot(starts[2 * i], starts[2 * i + 1]) / 50.0;
    sum -= (std::abs(starts[2 * i]) + std::abs(starts[2 * i + 1])) / 50.0;
  }
  CHECK(score.episodes == 50);
  CHECK(score.episode_length == PointEnv::kLength);
  CHECK(score.episode_return == Approx(PointEnv::kLength * sum).epsilon(1e-5));
  CHECK(score.episode_end_error_mm == Approx(error_mm).epsilon(1e-5));
  CHECK(score.episode_end_error_median_mm > 0.0);
  CHECK(score.action_saturation == 0.0);
  CHECK(evaluate.run(constant_actor(9.0F, 0.0F)).action_saturation == 0.5);
}

TEST_CASE("The curves have every figure of a score", "[rl]") {
  rl::PolicyScore score;
  score.episode_end_error_median_mm = 3.5;
  const common::Scalars scalars = rl::scalars_of(score);
  CHECK(scalars.size() == 6);
  CHECK(std::count(scalars.begin(), scalars.end(),
                   std::pair<std::string, double>("evaluation/episode_end_error_median_mm", 3.5)) == 1);
}
