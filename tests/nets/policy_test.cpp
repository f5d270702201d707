#include "lodestone/nets/policy.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/nets/checkpoint.h"
#include "temporary_folder.h"

namespace lodestone::nets {
namespace {

Policy sample_policy() {
  Policy policy;
  policy.hidden = {32, 16};
  policy.encoder.heading = "sine_cosine";
  policy.action.dead_band = 0.05;
  policy.goal = "centre";
  policy.actor = Actor(task::ObservationEncoder(policy.encoder).size(), policy.hidden);
  return policy;
}

TEST_CASE("actor and critic have the paper's shapes", "[unit]") {
  Actor actor(5, std::vector<std::int64_t>{256, 256});
  TwinCritic critic(5, std::vector<std::int64_t>{256, 256});
  const NamedTensors a = module_tensors(*actor);
  const NamedTensors c = module_tensors(*critic);
  CHECK(a.at("l1.weight").sizes() == torch::IntArrayRef({256, 5}));
  CHECK(a.at("l3.weight").sizes() == torch::IntArrayRef({2, 256}));
  CHECK(c.at("l1.weight").sizes() == torch::IntArrayRef({256, 7}));
  CHECK(c.at("l4.weight").sizes() == torch::IntArrayRef({256, 7}));
  CHECK(c.at("l6.weight").sizes() == torch::IntArrayRef({1, 256}));
  const torch::Tensor observation = torch::randn({9, 5});
  const torch::Tensor action = actor->forward(10.0 * observation);
  CHECK(action.abs().max().item<double>() <= 1.0);
  const auto [q1, q2] = critic->forward(observation, action);
  CHECK(torch::equal(q1, critic->first(observation, action)));
  CHECK_FALSE(torch::equal(q1, q2));
}

TEST_CASE("a policy comes back with its encoder and acts the same", "[unit]") {
  const tests::TemporaryFolder temporary;
  Policy policy = sample_policy();
  save_policy(temporary / "policy", policy, common::Json::object(), common::Json::object());
  Policy loaded = load_policy(temporary / "policy");
  CHECK(loaded.encoder.heading == "sine_cosine");
  CHECK(loaded.action.dead_band == 0.05);
  CHECK(loaded.goal == "centre");
  const torch::Tensor observation = torch::randn({4, task::ObservationEncoder(policy.encoder).size()});
  CHECK(torch::equal(policy.actor->forward(observation), loaded.actor->forward(observation)));
}

TEST_CASE("a policy whose examples do not recompute is refused", "[unit]") {
  const tests::TemporaryFolder temporary;
  save_policy(temporary / "policy", sample_policy(), common::Json::object(), common::Json::object());
  Checkpoint checkpoint = load_checkpoint(temporary / "policy", "policy");
  checkpoint.parts.at("examples").at("action") += 1e-3;
  save_checkpoint(temporary / "policy", checkpoint);
  CHECK_THROWS_WITH(load_policy(temporary / "policy"), Catch::Contains("recomputed example actions differ"));
  CHECK_THROWS_AS(load_policy(temporary / "none"), common::CheckpointError);
}

TEST_CASE("a policy keeps the region it was trained in", "[unit]") {
  const tests::TemporaryFolder temporary;
  Policy policy = sample_policy();
  std::vector<task::Move> moves;
  for (int i = 0; i < 40; ++i) moves.push_back({{0.001, 0.001}, {-0.003, 0.001}});
  for (int i = 0; i < 40; ++i) moves.push_back({{-0.003, 0.001}, {0.001, 0.001}});
  policy.region = task::Region(moves, {});
  save_policy(temporary / "policy", policy, common::Json::object(), common::Json::object());
  const Policy loaded = load_policy(temporary / "policy");
  REQUIRE(loaded.region);
  CHECK(loaded.region->contains({0.001, 0.001}));
  CHECK_FALSE(loaded.region->contains({0.02, 0.001}));
}

}  // namespace
}  // namespace lodestone::nets
