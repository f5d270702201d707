#include "lodestone/inference/folded_dynamics.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "env/linear_model.h"
#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/inference/checkpoint.h"
#include "lodestone/inference/dynamics.h"

using namespace lodestone;
using inference::DynamicsModel;

TEST_CASE("a folded network gives what its weights say, whatever normalises it", "[unit]") {
  // One hidden unit that passes the drive on: next x = x + 1e-3 * drive_x, by way of every normalisation.
  inference::DynamicsConfig config;
  config.form = inference::DynamicsForm::kDelta;
  config.hidden = {1};
  const auto numbers = [](std::vector<float> values) {
    const auto count = static_cast<std::int64_t>(values.size());
    return inference::Array(std::move(values), {count});
  };
  inference::Arrays weights = {{"input_mean", numbers({0, 0, 2, 0})},
                               {"input_std", numbers({1, 1, 4, 1})},
                               {"layers.0.weight", numbers({1, 1, 8, 1})},
                               {"layers.0.bias", numbers({0, 0, 3, 0})},
                               {"layers.0.running_mean", numbers({0, 0, 1, 0})},
                               {"layers.0.running_var", numbers({1, 1, 4, 1})},
                               {"layers.1.bias", numbers({1})},
                               {"layers.2.weight", numbers({2})},
                               {"layers.2.bias", numbers({5})},
                               {"layers.2.running_mean", numbers({0.5F})},
                               {"layers.2.running_var", numbers({0.25F})},
                               {"layers.4.bias", numbers({0, 1})},
                               {"output_mean", numbers({0.001F, 0})},
                               {"output_std", numbers({0.01F, 0.02F})}};
  weights["layers.1.weight"] = {std::vector<float>{0, 0, 1, 0}, {1, 4}};
  weights["layers.4.weight"] = {std::vector<float>{2, 0}, {2, 1}};
  const inference::FoldedDynamics folded(weights, config, data::StateLayout::kPosition, "test");
  inference::FoldedDynamics::Workspace workspace;
  for (const double drive : {-6.0, 0.0, 3.0, 12.0}) {
    const double state[2] = {0.01, 0.02};
    const double drives[2] = {drive, 7.0};
    double next[2];
    folded.predict(state, drives, 1, next, workspace);
    const double x = ((drive - 2.0) / 4.0 - 1.0) / std::sqrt(4.0 + 1e-5) * 8.0 + 3.0;  // of the drive
    const double hidden = std::max(0.0, (x + 1.0 - 0.5) / std::sqrt(0.25 + 1e-5) * 2.0 + 5.0);
    CHECK(next[0] == Approx(0.01 + 0.001 + 0.01 * 2.0 * hidden).margin(1e-6));
    CHECK(next[1] == Approx(0.02 + 0.02).margin(1e-8));
  }
  const auto fault_of = [&](const char* name, const inference::Array& value) {
    inference::Arrays spoiled = weights;
    spoiled[name] = value;
    try {
      inference::FoldedDynamics(spoiled, config, data::StateLayout::kPosition, "test");
    } catch (const common::CheckpointError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(fault_of("input_std", numbers({1, 1, 0, 1})),
             Catch::Contains("input_std") && Catch::Contains("above 0"));
  CHECK_THAT(fault_of("layers.2.running_var", numbers({-1})), Catch::Contains("above 0"));
  CHECK_THAT(fault_of("layers.2.bias", numbers({NAN})),
             Catch::Contains("test: array \"layers.2.bias\" holds nan"));
  CHECK_THAT(fault_of("layers.2.weight", numbers({INFINITY})), Catch::Contains("finite"));
  CHECK_THAT(fault_of("output_std", numbers({3e38F, 3e38F})), Catch::Contains("too large"));
  CHECK_THAT(fault_of("layers.2.bias", {std::vector<double>{5}, {1}}), Catch::Contains("float64"));
  weights.erase("layers.2.running_var");
  CHECK_THROWS_WITH(inference::FoldedDynamics(weights, config, data::StateLayout::kPosition, "test"),
                    Catch::Contains("test: array \"layers.2.running_var\" is missing"));
}

TEST_CASE("a linear model moves as it was made to, and wraps headings", "[unit]") {
  const DynamicsModel model = env::tests::linear_model(data::StateLayout::kPose, {1e-3}, {0.5});
  inference::FoldedDynamics::Workspace workspace;
  std::vector<double> state = {0.0, 0.01, 3.0, 0.02, 0.0, -1.0};
  const std::vector<double> drive = {5.0, -2.0, 0.0, 1.0};
  model.members.front().predict(state.data(), drive.data(), 2, state.data(), workspace);  // in place
  const std::vector<double> expected = {0.005, 0.008, 3.5 - 2.0 * geometry::kPi, 0.02, 0.001, -0.5};
  for (std::size_t i = 0; i < state.size(); ++i) CHECK(state[i] == Approx(expected[i]).margin(1e-6));
}

TEST_CASE("the density of a state is per metre and radian, and turns wrap around", "[unit]") {
  const DynamicsModel model = env::tests::noisy_linear_model(1e-3);
  const inference::FoldedDynamics& member = model.members.front();
  REQUIRE(member.distribution());
  inference::FoldedDynamics::Workspace workspace;
  const double state[6] = {0.01, 0.0, 3.14, 0.01, 0.0, 3.14};
  const double drive[4] = {2.0, 0.0, 2.0, 0.0};
  const double seen[6] = {0.012, 0.0, 3.14, 0.0122, 0.0, 3.1401 - 2.0 * geometry::kPi};
  const double exact[3] = {0.0, 0.0, 0.0};
  double log_density[2];
  member.log_density(state, drive, seen, exact, 2, log_density, workspace);
  const double sigma = env::tests::kLinearNoise_m;  // m, and rad
  const double peak = -3.0 * std::log(sigma * std::sqrt(2.0 * geometry::kPi));
  CHECK(log_density[0] == Approx(peak).epsilon(1e-4));
  CHECK(log_density[1] == Approx(peak - 0.5 - 0.125).epsilon(1e-3));
}

TEST_CASE("what is predicted can be had as a mixture in metres and radians", "[unit]") {
  const DynamicsModel noisy = env::tests::noisy_linear_model(1e-3);
  inference::FoldedDynamics::Workspace workspace;
  const double state[6] = {0.01, 0.0, 3.0, -0.02, 0.01, -1.0};
  const double drive[4] = {2.0, 0.0, -1.0, 4.0};
  const inference::PredictedMixture one = noisy.members.front().predict_mixture(state, drive, 2, workspace);
  CHECK(one.components == 1);
  CHECK(one.weight == std::vector<double>{1.0, 1.0});
  double mean[6];
  noisy.members.front().predict(state, drive, 2, mean, workspace);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(one.mean[i] == mean[i]);
    CHECK(one.spread[i] == Approx(env::tests::kLinearNoise_m).epsilon(1e-4));
  }
  const DynamicsModel exact = env::tests::linear_model(data::StateLayout::kPosition, {1e-3}, {});
  const inference::PredictedMixture value = exact.members.front().predict_mixture(state, drive, 1, workspace);
  CHECK(value.components == 1);
  CHECK(value.weight == std::vector<double>{1.0});
  CHECK(value.mean[0] == Approx(0.012).margin(1e-7));
  CHECK(value.spread == std::vector<double>{0.0, 0.0});
}

TEST_CASE("the components of a mixture are weighed and placed one by one", "[unit]") {
  const DynamicsModel model =
      inference::load_dynamics(std::string(LODESTONE_SOURCE_DIR) + "/models/dynamics_best");
  inference::FoldedDynamics::Workspace workspace;
  const double state[3] = {0.01, -0.005, 0.4};
  const double drive[2] = {6.0, -4.0};
  const inference::FoldedDynamics& member = model.members.front();
  const inference::PredictedMixture mixture = member.predict_mixture(state, drive, 1, workspace);
  REQUIRE(mixture.components == 3);
  REQUIRE(mixture.mean.size() == 9);
  double next[3];
  member.predict(state, drive, 1, next, workspace);
  double total = 0.0, x_m = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    total += mixture.weight[k];
    x_m += mixture.weight[k] * mixture.mean[3 * k];
    CHECK(mixture.spread[3 * k] > 0.0);
  }
  CHECK(total == Approx(1.0).epsilon(1e-6));
  CHECK(x_m == Approx(next[0]).epsilon(1e-5));
}

TEST_CASE("what is seen in an eighth of the dish happens alike in all eight ways of a square", "[unit]") {
  DynamicsModel model = inference::load_dynamics(std::string(LODESTONE_SOURCE_DIR) + "/models/dynamics_best");
  const inference::Checkpoint checkpoint =
      inference::load_checkpoint(std::string(LODESTONE_SOURCE_DIR) + "/models/dynamics_best", "dynamics");
  model.config.symmetry = inference::Symmetry::kSquare;
  const inference::FoldedDynamics member(checkpoint.parts.at(inference::member_part(0)), model.config,
                                         model.info.rows(), "square");
  inference::FoldedDynamics::Workspace workspace;
  const double state[3] = {0.017, 0.006, 2.4};
  const double drive[2] = {6.0, -4.0};
  const double noise[3] = {1e-4, 3e-4, 0.01};
  double next[3], log_density;
  member.predict(state, drive, 1, next, workspace);
  const double seen[3] = {next[0] + 4e-4, next[1] - 1e-4, next[2] + 0.02};
  member.log_density(state, drive, seen, noise, 1, &log_density, workspace);
  const inference::PredictedMixture mixture = member.predict_mixture(state, drive, 1, workspace);
  for (int way = 0; way < 8; ++way) {
    CAPTURE(way);
    const auto turned = [way](const double* xy, double* out) {
      const double angle_rad = 0.5 * geometry::kPi * way;
      const double y = way < 4 ? xy[1] : -xy[1];
      out[0] = std::cos(angle_rad) * xy[0] - std::sin(angle_rad) * y;
      out[1] = std::sin(angle_rad) * xy[0] + std::cos(angle_rad) * y;
    };
    const auto posed = [&](const double* pose, double* out) {
      turned(pose, out);
      out[2] = geometry::wrap_angle((way < 4 ? pose[2] : -pose[2]) + 0.5 * geometry::kPi * way);
    };
    double there[3], driven[2], wanted[3], found[3], seen_there[3], density_there;
    posed(state, there);
    turned(drive, driven);
    posed(next, wanted);
    member.predict(there, driven, 1, found, workspace);
    CHECK(found[0] == Approx(wanted[0]).margin(1e-7));
    CHECK(found[1] == Approx(wanted[1]).margin(1e-7));
    CHECK(geometry::wrap_angle(found[2] - wanted[2]) == Approx(0.0).margin(1e-5));
    posed(seen, seen_there);
    const bool swapped = way % 2 == 1;
    const double noise_there[3] = {noise[swapped ? 1 : 0], noise[swapped ? 0 : 1], noise[2]};
    member.log_density(there, driven, seen_there, noise_there, 1, &density_there, workspace);
    CHECK(density_there == Approx(log_density).epsilon(1e-3));
    const inference::PredictedMixture others = member.predict_mixture(there, driven, 1, workspace);
    CHECK(others.spread[0] == Approx(mixture.spread[swapped ? 1 : 0]).epsilon(1e-4));
    CHECK(others.spread[1] == Approx(mixture.spread[swapped ? 0 : 1]).epsilon(1e-4));
    CHECK(others.weight[0] == Approx(mixture.weight[0]).epsilon(1e-4));
  }
}

TEST_CASE("drives that are no vectors cannot be seen in an eighth of the dish", "[unit]") {
  inference::DynamicsConfig config;
  config.symmetry = inference::Symmetry::kSquare;
  const data::RowLayout four{data::StateLayout::kPose, 4};
  CHECK_THROWS_WITH(inference::FoldedDynamics({}, config, four, "four"), Catch::Contains("symmetry square"));
}
