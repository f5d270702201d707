#include "lodestone/rl/td3.h"

#include <catch2/catch.hpp>
#include <cmath>

#include <ATen/ATen.h>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "rl/td3_samples.h"

using lodestone::common::Json;
using lodestone::nets::NamedTensors;
using lodestone::rl::Batch;
using lodestone::rl::make_td3;
using lodestone::rl::ReplayBuffer;
using lodestone::rl::Td3Backend;
using lodestone::rl::Td3Config;
using lodestone::rl::UpdateResult;
using lodestone::rl::tests::identical;
using lodestone::rl::tests::random_buffer;
using lodestone::rl::tests::wave;

namespace {

// The file's own recipe for parameters: see its "description".
void set_reference_parameters(const NamedTensors& networks) {
  const at::NoGradGuard no_grad;
  const std::vector<std::pair<const char*, int>> starts = {
      {"actor.", 0}, {"critic.", 10}, {"actor_target.", 30}, {"critic_target.", 40}};
  for (const auto& [prefix, start] : starts) {
    int k = start;
    for (int layer = 1; layer <= 6; ++layer) {
      for (const char* part : {".weight", ".bias"}) {
        const auto found = networks.find(prefix + ("l" + std::to_string(layer)) + part);
        if (found == networks.end()) continue;
        at::Tensor tensor = found->second;
        const double scale =
            1.0 / std::sqrt(static_cast<double>(tensor.dim() == 2 ? tensor.size(1) : tensor.size(0)));
        tensor.copy_(
            (scale * at::sin(0.37 * at::arange(tensor.numel(), at::kDouble) + 1.3 * k)).view(tensor.sizes()));
        ++k;
      }
    }
  }
}

void check_tensor(const std::string& name, const at::Tensor& tensor, const Json& expected) {
  INFO(name);
  constexpr double kTolerance = 1e-9;
  const at::Tensor flat = tensor.contiguous().view({-1});
  CHECK(std::abs(flat.sum().item<double>() - expected["sum"].get<double>()) < kTolerance);
  CHECK(std::abs(flat.square().sum().item<double>() - expected["sum_of_squares"].get<double>()) < kTolerance);
  for (std::size_t i = 0; i < expected["first"].size(); ++i) {
    CHECK(std::abs(flat[static_cast<std::int64_t>(i)].item<double>() - expected["first"][i].get<double>()) <
          kTolerance);
  }
  CHECK(std::abs(flat[-1].item<double>() - expected["last"].get<double>()) < kTolerance);
}

NamedTensors copies(const NamedTensors& tensors) {
  NamedTensors result;
  for (const auto& [name, tensor] : tensors) result[name] = tensor.clone();
  return result;
}

}  // namespace

TEST_CASE("Two updates agree with the reference implementation to 1e-9", "[rl]") {
  const Json reference =
      lodestone::common::read_json_file(LODESTONE_SOURCE_DIR "/tests/rl/td3_reference_update.json");
  Td3Config config;
  config.batch_size = 16;
  for (const auto backend : {Td3Backend::kFused, Td3Backend::kAutograd}) {
    INFO(lodestone::common::name_of(backend));
    config.backend = backend;
    const auto td3 = make_td3(config, 5, 2, 1, 2, at::kDouble);
    set_reference_parameters(td3->networks());
    Batch batch(16, 5, 2, at::kDouble);
    batch.observation.copy_(wave(1, {16, 5}));
    batch.action.copy_(wave(2, {16, 2}));
    batch.next_observation.copy_(wave(3, {16, 5}));
    batch.reward.copy_(wave(4, {16}));
    batch.not_done.fill_(1.0);
    for (std::int64_t row = 3; row < 16; row += 4) batch.not_done[row] = 0.0;
    const at::Tensor noise = 0.3 * wave(5, {16, 2});
    REQUIRE(reference["after_update"].size() == 2);
    int update = 0;
    for (const Json& expected : reference["after_update"]) {
      const UpdateResult result = td3->update(batch, noise);
      CHECK(result.policy_updated == (++update == 2));
      CHECK(std::abs(result.critic_loss - expected["critic_loss_before"].get<double>()) < 1e-9);
      for (std::size_t i = 0; i < expected["target_q_first"].size(); ++i) {
        const double target = result.target_q[static_cast<std::int64_t>(i)].item<double>();
        CHECK(std::abs(target - expected["target_q_first"][i].get<double>()) < 1e-9);
      }
      std::size_t compared = 0;
      for (const char* network : {"actor", "critic", "actor_target", "critic_target"}) {
        for (const auto& [name, numbers] : expected[network].items()) {
          const std::string full = std::string(network) + "." + name;
          check_tensor(full, td3->networks().at(full), numbers);
          ++compared;
        }
      }
      CHECK(compared == td3->networks().size());
    }
  }
}

TEST_CASE("A loaded learner goes on bitwise", "[rl]") {
  Td3Config config;
  config.batch_size = 32;
  config.hidden = {32, 24};
  const ReplayBuffer buffer = random_buffer(200, 6);
  const auto whole = make_td3(config, 6, 2, 9);
  for (int i = 0; i < 11; ++i) whole->update(buffer);
  lodestone::nets::Checkpoint checkpoint;
  whole->save(checkpoint);
  const auto resumed = make_td3(config, 6, 2, 12345);
  resumed->load(checkpoint);
  CHECK(resumed->updates() == 11);
  for (int i = 0; i < 11; ++i)
    CHECK(whole->update(buffer).critic_loss == resumed->update(buffer).critic_loss);
  CHECK(identical(whole->networks(), resumed->networks()));

  Td3Config other = config;
  other.hidden = {32, 25};
  const auto wider = make_td3(other, 6, 2, 9);
  CHECK_THROWS_AS(wider->load(checkpoint), lodestone::common::CheckpointError);
  checkpoint.parts["optimiser"].erase("critic.second_moment.l5.bias");
  CHECK_THROWS_AS(resumed->load(checkpoint), lodestone::common::CheckpointError);
}

TEST_CASE("The policy and the targets move with every second update only, by the Polyak step", "[rl]") {
  Td3Config config;
  config.batch_size = 32;
  config.hidden = {16};
  config.polyak_tau = 0.25;
  const ReplayBuffer buffer = random_buffer(200, 4);
  const auto td3 = make_td3(config, 4, 2, 2);
  const NamedTensors start = copies(td3->networks());
  CHECK(at::equal(start.at("critic.l4.weight"), start.at("critic_target.l4.weight")));
  CHECK_FALSE(
      at::equal(start.at("critic.l1.weight"), start.at("critic.l3.weight")));  // twins are drawn apart
  td3->update(buffer);
  const NamedTensors first = copies(td3->networks());
  CHECK(at::equal(first.at("actor.l1.weight"), start.at("actor.l1.weight")));
  CHECK(at::equal(first.at("critic_target.l1.weight"), start.at("critic_target.l1.weight")));
  CHECK_FALSE(at::equal(first.at("critic.l1.weight"), start.at("critic.l1.weight")));
  td3->update(buffer);
  const NamedTensors second = td3->networks();
  for (const char* name : {"l1.weight", "l2.bias", "l3.weight"}) {
    const std::string text = name;
    const at::Tensor expected = 0.25 * second.at("critic." + text) + 0.75 * start.at("critic_target." + text);
    CHECK(at::allclose(second.at("critic_target." + text), expected, 0, 1e-7));
  }
  CHECK_FALSE(at::equal(second.at("actor.l1.weight"), start.at("actor.l1.weight")));
}

TEST_CASE("The learner's actor is the deployable actor", "[rl]") {
  const auto td3 = make_td3(Td3Config{}, 6, 2, 2);
  const NamedTensors weights = td3->actor_weights();
  const at::Tensor observation = wave(1, {10, 6}).to(at::kFloat);
  const std::vector<float> rows(observation.data_ptr<float>(), observation.data_ptr<float>() + 60);
  const std::vector<float> acted = td3->act(rows);
  at::Tensor expected = observation;
  for (const std::string layer : {"l1", "l2", "l3"}) {
    expected = at::linear(expected, weights.at(layer + ".weight"), weights.at(layer + ".bias"));
    expected = layer == "l3" ? expected.tanh() : expected.relu();
  }
  CHECK(at::allclose(at::tensor(acted).view({10, 2}), expected, 0, 1e-6));
  std::vector<float> plain(20);
  lodestone::inference::Actor::Workspace workspace;
  td3->actor().act(rows.data(), 10, plain.data(), workspace);
  CHECK(plain == acted);
}

TEST_CASE("An update refuses tensors of another shape or type", "[rl]") {
  Td3Config config;
  config.batch_size = 8;
  const auto td3 = make_td3(config, 4, 2, 2);
  CHECK_THROWS_AS(td3->update(Batch(7, 4, 2), at::zeros({8, 2})), lodestone::common::LogicFault);
  CHECK_THROWS_AS(td3->update(Batch(8, 4, 2, at::kDouble), at::zeros({8, 2})), lodestone::common::LogicFault);
  CHECK_THROWS_AS(td3->act(std::vector<float>(15)), lodestone::common::LogicFault);
}
