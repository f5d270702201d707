#include "lodestone/rl/td3.h"

#include <catch2/catch.hpp>
#include <cmath>

#include <torch/torch.h>

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/nets/actor_critic.h"
#include "lodestone/rl/flat_network.h"

using lodestone::common::Json;
using lodestone::common::RandomStream;
using lodestone::nets::NamedTensors;
using lodestone::rl::Batch;
using lodestone::rl::make_td3;
using lodestone::rl::ReplayBuffer;
using lodestone::rl::Td3Config;
using lodestone::rl::UpdateResult;

namespace {

torch::Tensor wave(double phase, torch::IntArrayRef shape) {
  std::int64_t count = 1;
  for (const std::int64_t n : shape) count *= n;
  return torch::sin(0.11 * torch::arange(count, torch::kFloat64) + 0.7 * phase).view(shape);
}

// The file's own recipe for parameters: see its "description".
void set_reference_parameters(const NamedTensors& networks) {
  const torch::NoGradGuard no_grad;
  const std::vector<std::pair<const char*, int>> starts = {
      {"actor.", 0}, {"critic.", 10}, {"actor_target.", 30}, {"critic_target.", 40}};
  for (const auto& [prefix, start] : starts) {
    int k = start;
    for (int layer = 1; layer <= 6; ++layer) {
      for (const char* part : {".weight", ".bias"}) {
        const auto found = networks.find(prefix + ("l" + std::to_string(layer)) + part);
        if (found == networks.end()) continue;
        torch::Tensor tensor = found->second;
        const double scale =
            1.0 / std::sqrt(static_cast<double>(tensor.dim() == 2 ? tensor.size(1) : tensor.size(0)));
        tensor.copy_((scale * torch::sin(0.37 * torch::arange(tensor.numel(), torch::kFloat64) + 1.3 * k))
                         .view(tensor.sizes()));
        ++k;
      }
    }
  }
}

void check_tensor(const std::string& name, const torch::Tensor& tensor, const Json& expected) {
  INFO(name);
  constexpr double kTolerance = 1e-9;
  const torch::Tensor flat = tensor.contiguous().view({-1});
  CHECK(std::abs(flat.sum().item<double>() - expected["sum"].get<double>()) < kTolerance);
  CHECK(std::abs(flat.square().sum().item<double>() - expected["sum_of_squares"].get<double>()) < kTolerance);
  for (std::size_t i = 0; i < expected["first"].size(); ++i) {
    CHECK(std::abs(flat[static_cast<std::int64_t>(i)].item<double>() - expected["first"][i].get<double>()) <
          kTolerance);
  }
  CHECK(std::abs(flat[-1].item<double>() - expected["last"].get<double>()) < kTolerance);
}

ReplayBuffer random_buffer(std::int64_t count, std::int64_t observation_size) {
  ReplayBuffer buffer(count, observation_size, 2);
  RandomStream random(5, "buffer");
  const auto draw = [&](std::int64_t columns) {
    std::vector<float> numbers(static_cast<std::size_t>(count * columns));
    for (float& number : numbers) number = static_cast<float>(random.uniform(-1, 1));
    return numbers;
  };
  lodestone::env::StepResult result;
  const std::vector<float> observation = draw(observation_size);
  const std::vector<float> action = draw(2);
  result.final_observation = draw(observation_size);
  result.reward = draw(1);
  for (const float number : draw(1)) result.terminated.push_back(number > 0.8F ? 1 : 0);
  result.truncated.assign(static_cast<std::size_t>(count), 0);
  buffer.add(observation, action, result);
  return buffer;
}

bool identical(const NamedTensors& one, const NamedTensors& two) {
  if (one.size() != two.size()) return false;
  for (const auto& [name, tensor] : one) {
    if (!torch::equal(tensor, two.at(name))) return false;
  }
  return true;
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
  for (const char* backend : {"fused", "autograd"}) {
    INFO(backend);
    config.backend = backend;
    const auto td3 = make_td3(config, 5, 2, 1, 2, torch::kFloat64);
    set_reference_parameters(td3->networks());
    Batch batch(16, 5, 2, torch::kFloat64);
    batch.observation.copy_(wave(1, {16, 5}));
    batch.action.copy_(wave(2, {16, 2}));
    batch.next_observation.copy_(wave(3, {16, 5}));
    batch.reward.copy_(wave(4, {16}));
    batch.not_done.fill_(1.0);
    for (std::int64_t row = 3; row < 16; row += 4) batch.not_done[row] = 0.0;
    const torch::Tensor noise = 0.3 * wave(5, {16, 2});
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

TEST_CASE("Hand-written gradients equal LibTorch's", "[rl]") {
  using lodestone::rl::FlatNetwork;
  FlatNetwork<double> network({7, 32, 16, 3});
  RandomStream random(3, "init");
  network.initialise(random);
  torch::nn::Sequential module(torch::nn::Linear(7, 32), torch::nn::ReLU(), torch::nn::Linear(32, 16),
                               torch::nn::ReLU(), torch::nn::Linear(16, 3));
  module->to(torch::kFloat64);
  const NamedTensors views = network.named(network.parameters(), "");
  std::vector<torch::Tensor> parameters = module->parameters();
  {
    const torch::NoGradGuard no_grad;
    for (int i = 0; i < 3; ++i) {
      const std::string layer = "l" + std::to_string(i + 1);
      parameters[2 * i].copy_(views.at(layer + ".weight"));
      parameters[2 * i + 1].copy_(views.at(layer + ".bias"));
    }
  }
  torch::Tensor input = wave(1, {9, 7}).requires_grad_(true);
  const torch::Tensor weight = wave(2, {9, 3});
  torch::Tensor output = module->forward(input);
  (output * weight).sum().backward();

  const torch::NoGradGuard no_grad;
  auto work = network.workspace(9);
  const double* rows = input.data_ptr<double>();
  network.forward(rows, work);
  CHECK(torch::allclose(work.output, output, 0, 1e-14));
  network.backward(rows, weight.data_ptr<double>(), work, FlatNetwork<double>::Wanted::kParameters);
  network.backward(rows, weight.data_ptr<double>(), work, FlatNetwork<double>::Wanted::kInput);
  CHECK(torch::allclose(work.input_gradient, input.grad(), 0, 1e-13));
  const NamedTensors gradient = network.named(work.gradient, "");
  for (int i = 0; i < 3; ++i) {
    const std::string layer = "l" + std::to_string(i + 1);
    CHECK(torch::allclose(gradient.at(layer + ".weight"), parameters[2 * i].grad(), 0, 1e-13));
    CHECK(torch::allclose(gradient.at(layer + ".bias"), parameters[2 * i + 1].grad(), 0, 1e-13));
  }
}

namespace {

/// Largest difference of two networks' moments or parameters, relative to the largest number of each tensor.
double largest_relative_difference(const NamedTensors& one, const NamedTensors& two) {
  REQUIRE(one.size() == two.size());
  double largest = 0.0;
  for (const auto& [name, tensor] : one) {
    const double size = two.at(name).abs().max().item<double>();
    largest = std::max(largest, (tensor - two.at(name)).abs().max().item<double>() / size);
  }
  return largest;
}

/// The gradients of one update of each backend from the same networks, batch and noise. After the first step
/// Adam's first moments are a tenth of the gradients, so they show the gradients of every parameter.
double gradient_difference(torch::ScalarType type) {
  Td3Config config;
  config.batch_size = 100;
  config.policy_frequency = 1;
  std::vector<NamedTensors> moments;
  for (const char* backend : {"fused", "autograd"}) {
    config.backend = backend;
    const auto td3 = make_td3(config, 6, 2, 4, 2, type);
    Batch batch(100, 6, 2, type);
    batch.observation.copy_(wave(1, {100, 6}));
    batch.action.copy_(wave(2, {100, 2}));
    batch.next_observation.copy_(wave(3, {100, 6}));
    batch.reward.copy_(wave(4, {100}));
    batch.not_done.fill_(1.0);
    td3->update(batch, (0.3 * wave(5, {100, 2})).to(type));
    lodestone::nets::Checkpoint checkpoint;
    td3->save(checkpoint);
    NamedTensors first;
    for (const auto& [name, tensor] : checkpoint.parts.at("optimiser")) {
      if (name.find("first_moment") != std::string::npos) first[name] = tensor;
    }
    moments.push_back(first);
  }
  CHECK(moments.front().size() == 18);
  return largest_relative_difference(moments[0], moments[1]);
}

}  // namespace

TEST_CASE("The fused backend's gradients are those of autograd", "[rl]") {
  // A network that autograd updates first would move the other's: both start from the seed's.
  CHECK(gradient_difference(torch::kFloat64) < 1e-10);
  CHECK(gradient_difference(torch::kFloat32) < 1e-5);
}

TEST_CASE("Backends stay together over many updates and take up each other's checkpoints", "[rl]") {
  Td3Config config;
  config.batch_size = 64;
  config.hidden = {32, 24};
  const auto fused = make_td3(config, 6, 2, 9, 2, torch::kFloat64);
  config.backend = "autograd";
  const auto autograd = make_td3(config, 6, 2, 9, 1, torch::kFloat64);
  CHECK(identical(fused->networks(), autograd->networks()));
  Batch batch(64, 6, 2, torch::kFloat64);
  const auto update_both = [&](int update) {
    batch.observation.copy_(wave(4 * update, {64, 6}));
    batch.action.copy_(wave(4 * update + 1, {64, 2}));
    batch.next_observation.copy_(wave(4 * update + 2, {64, 6}));
    batch.reward.copy_(wave(4 * update + 3, {64}));
    batch.not_done.fill_(1.0);
    const torch::Tensor noise = 0.3 * wave(update, {64, 2});
    const UpdateResult expected = autograd->update(batch, noise);
    const UpdateResult result = fused->update(batch, noise);
    CHECK(result.critic_loss == Approx(expected.critic_loss).epsilon(1e-9));
    CHECK(result.actor_loss == Approx(expected.actor_loss).epsilon(1e-9));
    CHECK(result.q_mean == Approx(expected.q_mean).epsilon(1e-9));
  };
  for (int update = 0; update < 20; ++update) update_both(update);
  lodestone::nets::Checkpoint one;
  lodestone::nets::Checkpoint two;
  fused->save(one);
  autograd->save(two);
  fused->load(two);
  autograd->load(one);
  for (int update = 20; update < 30; ++update) update_both(update);
  CHECK(largest_relative_difference(fused->networks(), autograd->networks()) < 1e-8);
}

TEST_CASE("Updates do not depend on the number of threads", "[rl]") {
  Td3Config config;
  config.batch_size = 64;
  const ReplayBuffer buffer = random_buffer(500, 6);
  const auto one = make_td3(config, 6, 2, 9, 1);
  const auto two = make_td3(config, 6, 2, 9, 2);
  const auto four = make_td3(config, 6, 2, 9, 4);
  for (int i = 0; i < 20; ++i) {
    const UpdateResult result = one->update(buffer);
    CHECK(two->update(buffer).critic_loss == result.critic_loss);
    CHECK(four->update(buffer).actor_loss == result.actor_loss);
  }
  CHECK(identical(one->networks(), two->networks()));
  CHECK(identical(one->networks(), four->networks()));
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
  CHECK(torch::equal(start.at("critic.l4.weight"), start.at("critic_target.l4.weight")));
  CHECK_FALSE(
      torch::equal(start.at("critic.l1.weight"), start.at("critic.l3.weight")));  // twins are drawn apart
  td3->update(buffer);
  const NamedTensors first = copies(td3->networks());
  CHECK(torch::equal(first.at("actor.l1.weight"), start.at("actor.l1.weight")));
  CHECK(torch::equal(first.at("critic_target.l1.weight"), start.at("critic_target.l1.weight")));
  CHECK_FALSE(torch::equal(first.at("critic.l1.weight"), start.at("critic.l1.weight")));
  td3->update(buffer);
  const NamedTensors second = td3->networks();
  for (const char* name : {"l1.weight", "l2.bias", "l3.weight"}) {
    const std::string text = name;
    const torch::Tensor expected =
        0.25 * second.at("critic." + text) + 0.75 * start.at("critic_target." + text);
    CHECK(torch::allclose(second.at("critic_target." + text), expected, 0, 1e-7));
  }
  CHECK_FALSE(torch::equal(second.at("actor.l1.weight"), start.at("actor.l1.weight")));
}

TEST_CASE("The learner's actor is the deployable actor", "[rl]") {
  const auto td3 = make_td3(Td3Config{}, 6, 2, 2);
  lodestone::nets::Actor actor(6, std::vector<std::int64_t>{256, 256});
  lodestone::nets::load_module_tensors(*actor, td3->actor_weights(), "actor");
  const torch::Tensor observation = wave(1, {10, 6}).to(torch::kFloat32);
  const std::vector<float> rows(observation.data_ptr<float>(), observation.data_ptr<float>() + 60);
  const std::vector<float> acted = td3->act(rows);
  CHECK(torch::allclose(torch::tensor(acted).view({10, 2}), actor->forward(observation), 0, 1e-6));
  std::vector<float> plain(20);
  lodestone::inference::Actor::Workspace workspace;
  td3->actor().act(rows.data(), 10, plain.data(), workspace);
  CHECK(plain == acted);
}

TEST_CASE("An update refuses tensors of another shape or type", "[rl]") {
  Td3Config config;
  config.batch_size = 8;
  const auto td3 = make_td3(config, 4, 2, 2);
  CHECK_THROWS_AS(td3->update(Batch(7, 4, 2), torch::zeros({8, 2})), lodestone::common::LogicFault);
  CHECK_THROWS_AS(td3->update(Batch(8, 4, 2, torch::kFloat64), torch::zeros({8, 2})),
                  lodestone::common::LogicFault);
  CHECK_THROWS_AS(td3->act(std::vector<float>(15)), lodestone::common::LogicFault);
}
