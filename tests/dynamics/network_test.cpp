#include "lodestone/dynamics/network.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>

#include "dynamics/sample_rows.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/inference/mixture.h"
#include "lodestone/nets/tensors.h"

namespace lodestone::dynamics {
namespace {

using inference::DynamicsForm;

using tests::config_of;
using tests::Rows;
using tests::sample_rows;

/// A network with batch statistics that differ from their defaults.
std::shared_ptr<Network> exercised(const DynamicsConfig& config, data::StateLayout layout) {
  const auto network = make_members(config, layout, 5).front();
  const Rows rows = sample_rows(layout, 512, 2);
  network->fit_normalisers(rows.state, rows.action, rows.next_state);
  network->train(true);
  const at::NoGradGuard no_grad;
  for (int i = 0; i < 20; ++i) network->normalised_output(rows.state, rows.action);
  network->train(false);
  return network;
}

TEST_CASE("the paper's network is 5-256-128-32-3", "[unit]") {
  const Network network(DynamicsConfig{}, data::StateLayout::kPose);
  const nets::NamedTensors tensors = network.tensors().named();
  // The input's normalisation has number 0; each hidden layer is linear, normalisation, ReLU.
  const std::pair<const char*, std::vector<std::int64_t>> shapes[] = {{"layers.1.weight", {256, 5}},
                                                                      {"layers.4.weight", {128, 256}},
                                                                      {"layers.7.weight", {32, 128}},
                                                                      {"layers.10.weight", {3, 32}},
                                                                      {"layers.8.running_var", {32}}};
  for (const auto& [name, shape] : shapes) CHECK(tensors.at(name).sizes().vec() == shape);
  CHECK(tensors.size() == 4 + 4 * 2 + 4 * 5);  // normalisers, linear layers, batch normalisations
}

TEST_CASE("the folded network agrees with the network", "[unit]") {
  const at::NoGradGuard no_grad;
  for (const auto layout : {data::StateLayout::kPose, data::StateLayout::kPosition}) {
    for (const auto form : {DynamicsForm::kPaper, DynamicsForm::kDelta}) {
      for (const auto& [batch_norm, input_relu] :
           {std::pair{true, false}, {true, true}, {false, false}, {false, true}}) {
        DynamicsConfig config = config_of(form, batch_norm);
        config.input_relu = input_relu;
        if (input_relu == batch_norm) config.symmetry = inference::Symmetry::kSquare;
        config.symmetry_exact = !batch_norm;
        config.needle_frame = input_relu;
        const auto network = exercised(config, layout);
        const Rows rows = sample_rows(layout, 77, 3);
        const at::Tensor expected = network->forward(rows.state, rows.action);
        at::Tensor next = at::empty_like(rows.state);
        const inference::FoldedDynamics folded = fold(*network);
        inference::FoldedDynamics::Workspace workspace;
        folded.predict(rows.state.data_ptr<double>(), rows.action.data_ptr<double>(), 77,
                       next.data_ptr<double>(), workspace);
        at::Tensor error = next - expected;
        if (layout == data::StateLayout::kPose) error.select(1, 2).copy_(wrap_angles(error.select(1, 2)));
        CAPTURE(common::name_of(form), batch_norm, input_relu);
        CHECK(error.abs().max().item<double>() < 1e-5);

        // A smaller batch in the same workspace, in place.
        at::Tensor state = rows.state.narrow(0, 10, 5).clone();
        folded.predict(state.data_ptr<double>(), rows.action.data_ptr<double>() + 20, 5,
                       state.data_ptr<double>(), workspace);
        CHECK((state - next.narrow(0, 10, 5)).abs().max().item<double>() < 1e-5);
      }
    }
  }
}

TEST_CASE("a network takes as many numbers of drive as the rig has", "[unit]") {
  const at::NoGradGuard no_grad;
  const DynamicsConfig config = config_of(DynamicsForm::kDelta, false);
  const data::RowLayout layout(data::StateLayout::kPose, 6);
  CHECK(config.inputs(layout) == 4 + 6);
  const auto network = make_members(config, layout, 5).front();
  network->train(false);
  at::manual_seed(3);
  const at::Tensor state = at::rand({20, 3}, at::kDouble), action = at::rand({20, 6}, at::kDouble);
  const inference::FoldedDynamics folded = fold(*network);
  CHECK(folded.action_size() == 6);
  inference::FoldedDynamics::Workspace workspace;
  at::Tensor next = at::empty_like(state);
  folded.predict(state.data_ptr<double>(), action.data_ptr<double>(), 20, next.data_ptr<double>(), workspace);
  CHECK((next - network->forward(state, action)).abs().max().item<double>() < 1e-5);
  const at::Tensor before = network->input_std.clone();
  network->scale_drive(2.0);
  CHECK(at::equal(network->input_std.narrow(0, 4, 6) * 2.0, before.narrow(0, 4, 6)));
  CHECK(at::equal(network->input_std.narrow(0, 0, 4), before.narrow(0, 0, 4)));
}

TEST_CASE("what tells of the drive goes in last and grows with it, after the eighth of the dish", "[unit]") {
  const at::NoGradGuard no_grad;
  DynamicsConfig config = config_of(DynamicsForm::kDelta, false);
  config.symmetry = inference::Symmetry::kSquare;
  config.needle_frame = true;
  const data::RowLayout layout(data::StateLayout::kPose);
  CHECK(config.inputs(layout) == 4 + 2 + 2);
  config.symmetry_exact = false;
  CHECK(config.inputs(layout) == 4 + 3 + 2 + 2);
  CHECK(config.inputs({data::StateLayout::kPose, 6}) == 4 + 3 + 6);
  CHECK(config.inputs({data::StateLayout::kPosition, 2}) == 2 + 3 + 2);
  const auto network = make_members(config, layout, 5).front();
  const double state[3] = {0.001, 0.02, geometry::kPi};  // in the north, heading west
  const double drive[2] = {-1.0, 3.0};
  std::vector<float> features(11);
  fold(*network).write_features(state, drive, 1, features.data());
  const std::vector<float> wanted = {0.02F, 0.001F, -1.0F, 0.0F, 0.0F, 1.0F, -1.0F, 1.0F, 3.0F, 3.0F, -1.0F};
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    CAPTURE(i);
    CHECK(features[i] == Approx(wanted[i]).margin(1e-6));
  }
  // Until it has learned, what looks the same comes out the same.
  network->train(false);
  const at::Tensor there =
      nets::tensor_from(std::vector<double>{0.02, 0.01, 0.4, -0.02, 0.01, geometry::kPi - 0.4}, {2, 3});
  const at::Tensor pulses = nets::tensor_from(std::vector<double>{5.0, 2.0, -5.0, 2.0}, {2, 2});
  const at::Tensor next = network->forward(there, pulses);
  CHECK(next[0][0].item<double>() == Approx(-next[1][0].item<double>()).margin(1e-7));
  CHECK(next[0][1].item<double>() == Approx(next[1][1].item<double>()).margin(1e-7));

  const at::Tensor before = network->input_std.clone();
  network->scale_drive(2.0);
  CHECK(at::equal(network->input_std.narrow(0, 7, 4) * 2.0, before.narrow(0, 7, 4)));
  CHECK(at::equal(network->input_std.narrow(0, 0, 7), before.narrow(0, 0, 7)));
}

TEST_CASE("normalisers are part of the network", "[unit]") {
  const Rows rows = sample_rows(data::StateLayout::kPose, 2000, 4);
  for (const auto form : {DynamicsForm::kPaper, DynamicsForm::kDelta}) {
    const auto network = exercised(config_of(form, true), data::StateLayout::kPose);
    network->fit_normalisers(rows.state, rows.action, rows.next_state);
    for (const at::Tensor& normalised : {network->normalised_input(rows.state, rows.action),
                                         network->normalised_target(rows.state, rows.next_state)}) {
      CHECK(normalised.mean(0).abs().max().item<double>() < 1e-4);
      CHECK((normalised.std(0, false) - 1.0).abs().max().item<double>() < 1e-4);
    }
    CHECK(network->tensors().named().count("input_mean") == 1);
    CHECK(network->tensors().named().count("output_std") == 1);
    // A network that gives the mean predicts the mean in physical units.
    const at::Tensor target = network->normalised_target(rows.state, rows.next_state);
    const at::Tensor error = network->normalised_output(rows.state, rows.action) - target;
    at::Tensor physical = network->forward(rows.state, rows.action) - rows.next_state;
    CHECK((error.select(1, 0) * network->output_std[0] - physical.select(1, 0)).abs().max().item<double>() <
          1e-5);
  }
}

TEST_CASE("the change form sees across the cut of the heading", "[unit]") {
  const auto network = exercised(config_of(DynamicsForm::kDelta, false), data::StateLayout::kPose);
  const at::Tensor action = at::zeros({2, 2}, at::kDouble);
  const at::Tensor state =
      nets::tensor_from({0.0, 0.0, geometry::kPi - 1e-7, 0.0, 0.0, -geometry::kPi + 1e-7}, {2, 3});
  const at::Tensor next = network->forward(state, action);
  CHECK(std::abs((next[0][0] - next[1][0]).item<double>()) < 1e-6);
  const at::Tensor turned = nets::tensor_from({0.0, 0.0, -geometry::kPi + 0.1}, {1, 3});
  const at::Tensor before = nets::tensor_from({0.0, 0.0, geometry::kPi - 0.1}, {1, 3});
  const at::Tensor target =
      network->normalised_target(before, turned) * network->output_std + network->output_mean;
  CHECK(target[0][2].item<double>() == Approx(0.2).margin(1e-5));
}

TEST_CASE("angles wrap to (-pi, pi]", "[unit]") {
  const at::Tensor wrapped =
      wrap_angles(nets::tensor_from({geometry::kPi, -geometry::kPi, 3 * geometry::kPi, 0.5, 7.0, -7.0}, {6}));
  const std::vector<double> expected = {geometry::kPi, geometry::kPi,           geometry::kPi,
                                        0.5,           7.0 - 2 * geometry::kPi, 2 * geometry::kPi - 7.0};
  for (int i = 0; i < 6; ++i)
    CHECK(wrapped[i].item<double>() == Approx(expected[static_cast<std::size_t>(i)]));
}

TEST_CASE("the mean of headings is taken on the circle", "[unit]") {
  DynamicsConfig config = config_of(DynamicsForm::kDelta, true);
  config.members = 2;
  const Members members = make_members(config, data::StateLayout::kPose, 8);
  const at::NoGradGuard no_grad;
  for (std::size_t k = 0; k < 2; ++k) {
    for (auto& parameter : members[k]->tensors().parameters()) parameter.zero_();
    members[k]->output_mean[2].fill_(k == 0 ? 0.2 : -0.1);
  }
  const at::Tensor next = predict_mean(members, nets::tensor_from({0.0, 0.0, geometry::kPi - 0.01}, {1, 3}),
                                       at::zeros({1, 2}, at::kDouble));
  CHECK(std::abs(wrap_angles(next[0][2] - (geometry::kPi + 0.04)).item<double>()) < 1e-6);
}

TEST_CASE("initial weights follow the seed and PyTorch's default range", "[unit]") {
  const DynamicsConfig config = config_of(DynamicsForm::kPaper, false);
  auto first = make_members(config, data::StateLayout::kPose, 1).front();
  auto again = make_members(config, data::StateLayout::kPose, 1).front();
  auto other = make_members(config, data::StateLayout::kPose, 2).front();
  const auto weight = [](const std::shared_ptr<Network>& network) {
    return network->tensors().named().at("layers.2.weight");
  };
  CHECK(at::equal(weight(first), weight(again)));
  CHECK_FALSE(at::equal(weight(first), weight(other)));
  CHECK(weight(first).abs().max().item<double>() <= 1.0 / 8.0);
  CHECK(weight(first).std().item<double>() == Approx(1.0 / 8.0 / std::sqrt(3.0)).epsilon(0.05));
}

TEST_CASE("a mixture's mean survives folding and saving, and its draws scatter around it", "[unit]") {
  for (const auto& [form, batch_norm] :
       {std::pair{DynamicsForm::kPaper, true}, std::pair{DynamicsForm::kDelta, false}}) {
    CAPTURE(common::name_of(form));
    DynamicsConfig config = config_of(form, batch_norm);
    config.components = 3;
    const auto network = exercised(config, data::StateLayout::kPose);
    const Rows rows = sample_rows(data::StateLayout::kPose, 200, 3);
    const at::NoGradGuard no_grad;
    const at::Tensor expected = network->forward(rows.state, rows.action).to(at::kDouble).contiguous();
    const inference::FoldedDynamics folded = fold(*network);
    inference::FoldedDynamics::Workspace workspace;
    std::vector<double> mean(600);
    folded.predict(rows.state.data_ptr<double>(), rows.action.data_ptr<double>(), 200, mean.data(),
                   workspace);
    const at::Tensor means = nets::tensor_from(mean, {200, 3});
    CHECK((means - expected).narrow(1, 0, 2).abs().max().item<double>() < 1e-6);
    CHECK(wrap_angles((means - expected).select(1, 2)).abs().max().item<double>() < 1e-4);

    // The average of many draws comes to the mean.
    common::RandomStream random(5, "draws");
    const std::vector<common::RandomStream*> streams(200, &random);
    at::Tensor sum = at::zeros({200, 2}, at::kDouble);
    std::vector<double> drawn(600);
    constexpr int kDraws = 3000;
    for (int i = 0; i < kDraws; ++i) {
      folded.sample(rows.state.data_ptr<double>(), rows.action.data_ptr<double>(), 200, streams.data(),
                    drawn.data(), workspace);
      sum += nets::tensor_from(drawn, {200, 3}).narrow(1, 0, 2);
    }
    const double spread_m = network->output_std[0].item<double>() * std::exp(inference::kMostLogSpread);
    CHECK((sum / kDraws - means.narrow(1, 0, 2)).abs().max().item<double>() < 0.1 * spread_m);
  }
}

}  // namespace
}  // namespace lodestone::dynamics
