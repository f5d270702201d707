#include "lodestone/dynamics/model.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "dynamics/sample_rows.h"
#include "lodestone/common/error.h"
#include "lodestone/dynamics/network.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/inference/dynamics.h"
#include "temporary_folder.h"

namespace lodestone::dynamics {
namespace {

using inference::DynamicsForm;

Model sample_model(data::StateLayout layout, inference::Symmetry symmetry = inference::Symmetry::kNone) {
  Model model;
  model.config = tests::config_of(DynamicsForm::kDelta, true);
  model.config.symmetry = symmetry;
  model.config.members = 3;
  model.info.layout = layout;
  model.info.source = "test";
  model.info.workspace_radius_m = 0.0425;
  model.members = make_members(model.config, layout, 8);
  const tests::Rows rows = tests::sample_rows(layout, 100, 6);
  for (auto& member : model.members) member->fit_normalisers(rows.state, rows.action, rows.next_state);
  model.start_states = nets::to_array(rows.state);
  model.split = {9, 0.2, 0.1};
  model.training_rows = {nets::to_array(rows.state.to(at::kFloat)),
                         nets::to_array(rows.action.to(at::kFloat)),
                         nets::to_array(rows.next_state.to(at::kFloat))};
  return model;
}

TEST_CASE("a saved ensemble predicts the same after loading", "[unit]") {
  const auto symmetry = GENERATE(inference::Symmetry::kNone, inference::Symmetry::kSquare);
  for (const auto layout : {data::StateLayout::kPose, data::StateLayout::kPosition}) {
    const ::lodestone::tests::TemporaryFolder temporary;
    Model model = sample_model(layout, symmetry);
    save_model(temporary / "model", model, common::Json::object(), common::Json::object());
    Model loaded = load_model(temporary / "model");
    const tests::Rows rows = tests::sample_rows(layout, 33, 7);
    CHECK(at::equal(predict_mean(model.members, rows.state, rows.action),
                    predict_mean(loaded.members, rows.state, rows.action)));
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
    at::Tensor next = at::empty_like(rows.state);
    plain.members[1].predict(rows.state.data_ptr<double>(), rows.action.data_ptr<double>(), 33,
                             next.data_ptr<double>(), workspace);
    const at::Tensor expected = model.members[1]->forward(rows.state, rows.action);
    CHECK((next - expected).narrow(1, 0, 2).abs().max().item<double>() < 1e-5);
  }
}

TEST_CASE("rows that fit neither the layout nor each other, and impossible splits are refused", "[unit]") {
  const ::lodestone::tests::TemporaryFolder temporary;
  const std::string folder = temporary / "model";
  const auto fault_of = [&](const auto& spoil) {
    save_model(folder, sample_model(data::StateLayout::kPose), common::Json::object(),
               common::Json::object());
    inference::Checkpoint checkpoint = inference::load_checkpoint(folder, "dynamics");
    spoil(checkpoint);
    inference::save_checkpoint(folder, checkpoint);
    try {
      load_model(folder);
    } catch (const common::CheckpointError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  using inference::Array;
  CHECK_THAT(fault_of([](auto& c) {
               c.parts["rows"]["action"] = Array(std::vector<float>(4), {2, 2});
             }),
             Catch::Contains("as many actions"));
  CHECK_THAT(fault_of([](auto& c) {
               c.parts["rows"]["state"] = Array(std::vector<float>(4), {2, 2});
             }),
             Catch::Contains("expected rows of 3"));
  CHECK_THAT(fault_of([](auto& c) {
               c.parts["rows"]["start_states"] = Array(std::vector<float>{0, NAN, 0}, {1, 3});
             }),
             Catch::Contains("start_states") && Catch::Contains("finite"));
  CHECK_THAT(fault_of([](auto& c) { c.facts["split"]["test_fraction"] = 1e300; }),
             Catch::Contains("fractions"));
  CHECK_THAT(fault_of([](auto& c) { c.facts["dataset"]["control_period_s"] = 1e300; }),
             Catch::Contains("control_period_s"));
  CHECK_THAT(fault_of([](auto& c) { c.facts["model"]["hidden"] = std::vector<int>(16, 8192); }),
             Catch::Contains("expected"));  // before 4 GB are taken
  CHECK_THAT(fault_of([](auto& c) { c.facts["model"]["hidden"] = std::vector<int>(17, 8); }),
             Catch::Contains("at most 16 layers"));
}

}  // namespace
}  // namespace lodestone::dynamics
