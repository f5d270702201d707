#include "lodestone/nets/dynamics_network.h"

#include <catch2/catch.hpp>

#include <torch/torch.h>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/inference/dynamics.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/nets/mlp.h"
#include "lodestone/nets/tensors.h"
#include "temporary_folder.h"

namespace lodestone::nets {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Rows {
  torch::Tensor state, action, next_state;  // float64
};

/// Rows over the dish whose motion is some smooth function of state and drive.
Rows sample_rows(data::StateLayout layout, std::int64_t count, std::uint64_t seed) {
  common::RandomStream random(seed, "rows");
  const int size = data::state_size(layout);
  Rows rows{torch::empty({count, size}, torch::kFloat64), torch::empty({count, 2}, torch::kFloat64),
            torch::empty({count, size}, torch::kFloat64)};
  auto state = rows.state.accessor<double, 2>();
  auto action = rows.action.accessor<double, 2>();
  auto next = rows.next_state.accessor<double, 2>();
  for (std::int64_t i = 0; i < count; ++i) {
    for (int d = 0; d < 2; ++d) {
      state[i][d] = random.uniform(-0.03, 0.03);
      action[i][d] = random.uniform(-15.0, 15.0);
      next[i][d] = state[i][d] + 3e-4 * action[i][d] * (1.0 + 10.0 * state[i][d]);
    }
    if (size == 3) {
      state[i][2] = random.uniform(-kPi, kPi);
      next[i][2] = std::remainder(state[i][2] + 0.02 * action[i][0], 2.0 * kPi);
    }
  }
  return rows;
}

/// A network with batch statistics that differ from their defaults.
DynamicsNetwork exercised(const DynamicsConfig& config, data::StateLayout layout) {
  DynamicsNetwork network = make_dynamics_members(config, layout, 5).front();
  const Rows rows = sample_rows(layout, 512, 2);
  network->fit_normalisers(rows.state, rows.action, rows.next_state);
  network->train();
  const torch::NoGradGuard no_grad;
  for (int i = 0; i < 20; ++i) network->normalised_output(rows.state, rows.action);
  network->eval();
  return network;
}

DynamicsConfig config_of(const std::string& form, bool batch_norm) {
  DynamicsConfig config;
  config.form = form;
  config.batch_norm = batch_norm;
  config.hidden = {64, 32, 16};
  return config;
}

TEST_CASE("the paper's network is 5-256-128-32-3", "[unit]") {
  const DynamicsNetwork network(DynamicsConfig{}, data::StateLayout::kPose);
  std::vector<std::vector<std::int64_t>> shapes;
  for (const auto& child : const_cast<DynamicsNetwork&>(network)->layers()->children()) {
    if (const auto* linear = child->as<torch::nn::LinearImpl>())
      shapes.push_back(linear->weight.sizes().vec());
  }
  CHECK(shapes == std::vector<std::vector<std::int64_t>>{{256, 5}, {128, 256}, {32, 128}, {3, 32}});
}

TEST_CASE("the folded network agrees with the network", "[unit]") {
  const torch::NoGradGuard no_grad;
  for (const auto layout : {data::StateLayout::kPose, data::StateLayout::kPosition}) {
    for (const char* form : {"paper", "delta"}) {
      for (const bool batch_norm : {true, false}) {
        DynamicsNetwork network = exercised(config_of(form, batch_norm), layout);
        const Rows rows = sample_rows(layout, 77, 3);
        const torch::Tensor expected = network->forward(rows.state, rows.action);
        torch::Tensor next = torch::empty_like(rows.state);
        const inference::FoldedDynamics folded = fold(*network);
        inference::FoldedDynamics::Workspace workspace;
        folded.predict(rows.state.data_ptr<double>(), rows.action.data_ptr<double>(), 77,
                       next.data_ptr<double>(), workspace);
        torch::Tensor error = next - expected;
        if (layout == data::StateLayout::kPose) error.select(1, 2).copy_(wrap_angles(error.select(1, 2)));
        CAPTURE(form, batch_norm);
        CHECK(error.abs().max().item<double>() < 1e-5);

        // A smaller batch in the same workspace, in place.
        torch::Tensor state = rows.state.narrow(0, 10, 5).clone();
        folded.predict(state.data_ptr<double>(), rows.action.data_ptr<double>() + 20, 5,
                       state.data_ptr<double>(), workspace);
        CHECK((state - next.narrow(0, 10, 5)).abs().max().item<double>() < 1e-5);
      }
    }
  }
}

TEST_CASE("normalisers are part of the network", "[unit]") {
  const Rows rows = sample_rows(data::StateLayout::kPose, 2000, 4);
  for (const char* form : {"paper", "delta"}) {
    DynamicsNetwork network = exercised(config_of(form, true), data::StateLayout::kPose);
    network->fit_normalisers(rows.state, rows.action, rows.next_state);
    for (const torch::Tensor& normalised : {network->normalised_input(rows.state, rows.action),
                                            network->normalised_target(rows.state, rows.next_state)}) {
      CHECK(normalised.mean(0).abs().max().item<double>() < 1e-4);
      CHECK((normalised.std(0, false) - 1.0).abs().max().item<double>() < 1e-4);
    }
    CHECK(module_tensors(*network).count("input_mean") == 1);
    CHECK(module_tensors(*network).count("output_std") == 1);
    // A network that gives the mean predicts the mean in physical units.
    const torch::Tensor target = network->normalised_target(rows.state, rows.next_state);
    const torch::Tensor error = network->normalised_output(rows.state, rows.action) - target;
    torch::Tensor physical = network->forward(rows.state, rows.action) - rows.next_state;
    CHECK((error.select(1, 0) * network->output_std[0] - physical.select(1, 0)).abs().max().item<double>() <
          1e-5);
  }
}

TEST_CASE("the change form sees across the cut of the heading", "[unit]") {
  DynamicsNetwork network = exercised(config_of("delta", false), data::StateLayout::kPose);
  const torch::Tensor action = torch::zeros({2, 2}, torch::kFloat64);
  const torch::Tensor state = tensor_from({0.0, 0.0, kPi - 1e-7, 0.0, 0.0, -kPi + 1e-7}, {2, 3});
  const torch::Tensor next = network->forward(state, action);
  CHECK(std::abs((next[0][0] - next[1][0]).item<double>()) < 1e-6);
  const torch::Tensor turned = tensor_from({0.0, 0.0, -kPi + 0.1}, {1, 3});
  const torch::Tensor before = tensor_from({0.0, 0.0, kPi - 0.1}, {1, 3});
  const torch::Tensor target =
      network->normalised_target(before, turned) * network->output_std + network->output_mean;
  CHECK(target[0][2].item<double>() == Approx(0.2).margin(1e-5));
}

TEST_CASE("angles wrap to (-pi, pi]", "[unit]") {
  const torch::Tensor wrapped = wrap_angles(tensor_from({kPi, -kPi, 3 * kPi, 0.5, 7.0, -7.0}, {6}));
  const std::vector<double> expected = {kPi, kPi, kPi, 0.5, 7.0 - 2 * kPi, 2 * kPi - 7.0};
  for (int i = 0; i < 6; ++i)
    CHECK(wrapped[i].item<double>() == Approx(expected[static_cast<std::size_t>(i)]));
}

DynamicsModel sample_model(data::StateLayout layout) {
  DynamicsModel model;
  model.config = config_of("delta", true);
  model.config.members = 3;
  model.info.layout = layout;
  model.info.source = "test";
  model.members = make_dynamics_members(model.config, layout, 8);
  const Rows rows = sample_rows(layout, 100, 6);
  for (auto& member : model.members) member->fit_normalisers(rows.state, rows.action, rows.next_state);
  model.start_states = to_array(rows.state);
  model.split = {9, 0.2, 0.1};
  model.training_rows = {to_array(rows.state.to(torch::kFloat32)), to_array(rows.action.to(torch::kFloat32)),
                         to_array(rows.next_state.to(torch::kFloat32))};
  return model;
}

TEST_CASE("a saved ensemble predicts the same after loading", "[unit]") {
  for (const auto layout : {data::StateLayout::kPose, data::StateLayout::kPosition}) {
    const tests::TemporaryFolder temporary;
    DynamicsModel model = sample_model(layout);
    save_dynamics(temporary / "model", model, common::Json::object(), common::Json::object());
    DynamicsModel loaded = load_dynamics(temporary / "model");
    const Rows rows = sample_rows(layout, 33, 7);
    CHECK(torch::equal(predict_mean(model, rows.state, rows.action),
                       predict_mean(loaded, rows.state, rows.action)));
    CHECK(loaded.info.layout == layout);
    CHECK(loaded.info.source == "test");
    CHECK(loaded.split.seed == 9);
    CHECK(identical(loaded.start_states, model.start_states));
    CHECK(identical(loaded.training_rows.next_state, model.training_rows.next_state));
    // The same file without LibTorch.
    const inference::DynamicsModel plain = inference::load_dynamics(temporary / "model");
    REQUIRE(plain.members.size() == 3);
    CHECK(plain.start_states == model.start_states.to_double());
    REQUIRE(plain.recorded_moves.size() == 100);
    CHECK(plain.recorded_moves[7].to_m.y() ==
          Approx(model.training_rows.next_state
                     .to_double()[static_cast<std::size_t>(7 * data::state_size(layout) + 1)]));
    inference::FoldedDynamics::Workspace workspace;
    torch::Tensor next = torch::empty_like(rows.state);
    plain.members[1].predict(rows.state.data_ptr<double>(), rows.action.data_ptr<double>(), 33,
                             next.data_ptr<double>(), workspace);
    const torch::Tensor expected = model.members[1]->forward(rows.state, rows.action);
    CHECK((next - expected).narrow(1, 0, 2).abs().max().item<double>() < 1e-5);
  }
}

TEST_CASE("the mean of headings is taken on the circle", "[unit]") {
  DynamicsModel model = sample_model(data::StateLayout::kPose);
  model.members.pop_back();
  const torch::NoGradGuard no_grad;
  for (std::size_t k = 0; k < 2; ++k) {
    for (auto& parameter : model.members[k]->parameters()) parameter.zero_();
    model.members[k]->output_mean[2].fill_(k == 0 ? 0.2 : -0.1);
  }
  const torch::Tensor next =
      predict_mean(model, tensor_from({0.0, 0.0, kPi - 0.01}, {1, 3}), torch::zeros({1, 2}, torch::kFloat64));
  CHECK(std::abs(wrap_angles(next[0][2] - (kPi + 0.04)).item<double>()) < 1e-6);
}

TEST_CASE("initial weights follow the seed and PyTorch's default range", "[unit]") {
  const DynamicsConfig config = config_of("paper", false);
  auto first = make_dynamics_members(config, data::StateLayout::kPose, 1).front();
  auto again = make_dynamics_members(config, data::StateLayout::kPose, 1).front();
  auto other = make_dynamics_members(config, data::StateLayout::kPose, 2).front();
  const auto weight = [](const std::shared_ptr<DynamicsNetworkImpl>& network) {
    return module_tensors(*network).at("layers.2.weight");
  };
  CHECK(torch::equal(weight(first), weight(again)));
  CHECK_FALSE(torch::equal(weight(first), weight(other)));
  CHECK(weight(first).abs().max().item<double>() <= 1.0 / 8.0);
  CHECK(weight(first).std().item<double>() == Approx(1.0 / 8.0 / std::sqrt(3.0)).epsilon(0.05));
}

TEST_CASE("a mixture's mean survives folding and saving, and its draws scatter around it", "[unit]") {
  for (const auto& [form, batch_norm] : {std::pair{"paper", true}, std::pair{"delta", false}}) {
    CAPTURE(form);
    DynamicsConfig config = config_of(form, batch_norm);
    config.components = 3;
    DynamicsNetwork network = exercised(config, data::StateLayout::kPose);
    const Rows rows = sample_rows(data::StateLayout::kPose, 200, 3);
    const torch::NoGradGuard no_grad;
    const torch::Tensor expected = network->forward(rows.state, rows.action).to(torch::kFloat64).contiguous();
    const inference::FoldedDynamics folded = fold(*network);
    inference::FoldedDynamics::Workspace workspace;
    std::vector<double> mean(600);
    folded.predict(rows.state.data_ptr<double>(), rows.action.data_ptr<double>(), 200, mean.data(),
                   workspace);
    const torch::Tensor means = tensor_from(mean, {200, 3});
    CHECK((means - expected).narrow(1, 0, 2).abs().max().item<double>() < 1e-6);
    CHECK(wrap_angles((means - expected).select(1, 2)).abs().max().item<double>() < 1e-4);

    // The average of many draws comes to the mean.
    common::RandomStream random(5, "draws");
    const std::vector<common::RandomStream*> streams(200, &random);
    torch::Tensor sum = torch::zeros({200, 2}, torch::kFloat64);
    std::vector<double> drawn(600);
    constexpr int kDraws = 3000;
    for (int i = 0; i < kDraws; ++i) {
      folded.sample(rows.state.data_ptr<double>(), rows.action.data_ptr<double>(), 200, streams.data(),
                    drawn.data(), workspace);
      sum += tensor_from(drawn, {200, 3}).narrow(1, 0, 2);
    }
    const double spread_m = network->output_std[0].item<double>() * std::exp(inference::kMostLogSpread);
    CHECK((sum / kDraws - means.narrow(1, 0, 2)).abs().max().item<double>() < 0.1 * spread_m);
  }
}

}  // namespace
}  // namespace lodestone::nets
