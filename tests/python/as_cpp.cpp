#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "environment_config.h"
#include "lodestone/control/planner.h"
#include "lodestone/control/policy_controller.h"
#include "lodestone/env/mbs_env.h"
#include "lodestone/inference/policy.h"

// What the package of Python shall agree with, computed without it.
//   as_cpp values DYNAMICS POLICY CONFIG     raw doubles to the output, in the order of same_as_cpp_test.py
//   as_cpp rate DYNAMICS CONFIG COUNT THREADS SECONDS     steps per second of the MBS

using namespace lodestone;

namespace {

void put(double value) { std::fwrite(&value, sizeof value, 1, stdout); }
template <class Number>
void put(const std::vector<Number>& values) {
  for (const Number value : values) put(static_cast<double>(value));
}

/// Numbers in [-1, 1] that no library's sine has a say in.
double number(std::int64_t i) { return static_cast<double>((i * 7919) % 2001 - 1000) / 1000.0; }

env::MbsEnv make_env(const inference::DynamicsModel& model, const std::string& config_file,
                     std::int64_t count, std::int64_t threads) {
  auto config = common::config_from_json<python::EnvironmentConfig>(common::read_json_file(config_file), "");
  env::adopt_data(model.info, config.task, config.encoder, config.action);
  env::EpisodeSettings settings;
  settings.count = count;
  settings.task = config.task;
  settings.encoder = config.encoder;
  settings.action = config.action;
  settings.seed = 5;
  return {model, settings, config.mbs, threads};
}

void put_predictions(const inference::DynamicsModel& model) {
  inference::FoldedDynamics::Workspace workspace;
  std::vector<double> state, drive, mean(3 * 20), scratch;
  for (std::int64_t i = 0; i < 20; ++i) {
    for (const double scale : {0.03, 0.03, 3.0})
      state.push_back(scale * number(3 * i + (scale > 1.0 ? 2 : 0)));
    for (std::int64_t axis = 0; axis < 2; ++axis) drive.push_back(15.0 * number(100 + 2 * i + axis));
  }
  inference::predict_mean(model.members, state.data(), drive.data(), 20, mean.data(), scratch, workspace);
  put(mean);
  for (const inference::FoldedDynamics& member : model.members) {
    const inference::PredictedMixture mixture =
        member.predict_mixture(state.data(), drive.data(), 20, workspace);
    put(mixture.weight);
    put(mixture.mean);
    put(mixture.spread);
  }
}

/// Decisions one after the other; `remember` as the control loop does.
void put_decisions(control::Controller& controller) {
  controller.reset();
  task::Observation observation;
  for (std::int64_t i = 0; i < 8; ++i) {
    const geometry::Pose2 pose{0.03 * number(i), 0.03 * number(i + 50), 3.0 * number(i + 70)};
    if (i > 0) observation.last_displacement_m = pose.position_m() - observation.pose.position_m();
    observation.pose = pose;
    observation.target_m = {0.01, -0.005};
    observation.last_action = controller.act(observation);
    put(observation.last_action.x());
    put(observation.last_action.y());
  }
}

void put_steps(env::MbsEnv environments) {
  put(environments.reset());
  const std::int64_t count = environments.spec().count;
  std::vector<float> actions(static_cast<std::size_t>(2 * count));
  for (std::int64_t step = 0; step < 60; ++step) {
    for (std::size_t i = 0; i < actions.size(); ++i)
      actions[i] = static_cast<float>(number(step * 31 + static_cast<std::int64_t>(i)));
    const env::StepResult& result = environments.step(actions);
    put(result.observation);
    put(result.reward);
    put(result.terminated);
    put(result.truncated);
    put(result.success);
    put(result.final_observation);
  }
}

void print_rate(env::MbsEnv environments, double seconds) {
  using Clock = std::chrono::steady_clock;
  const std::int64_t count = environments.spec().count;
  std::vector<float> actions(static_cast<std::size_t>(2 * count));
  for (std::size_t i = 0; i < actions.size(); ++i)
    actions[i] = static_cast<float>(number(static_cast<std::int64_t>(i)));
  environments.reset();
  for (int step = 0; step < 3; ++step) environments.step(actions);
  std::int64_t steps = 0;
  const auto start = Clock::now();
  double passed_s = 0.0;
  while (passed_s < seconds) {
    environments.step(actions);
    ++steps;
    passed_s = std::chrono::duration<double>(Clock::now() - start).count();
  }
  std::printf("%.0f\n", static_cast<double>(steps * count) / passed_s);
}

}  // namespace

int main(int count, char** words) {
  const std::string what = count > 1 ? words[1] : "";
  if (what == "rate" && count == 7) {
    print_rate(
        make_env(inference::load_dynamics(words[2]), words[3], std::atoll(words[4]), std::atoll(words[5])),
        std::atof(words[6]));
    return 0;
  }
  if (what != "values" || count != 5) return 2;
  const inference::DynamicsModel model = inference::load_dynamics(words[2]);
  put_predictions(model);
  const inference::Policy policy = inference::load_policy(words[3]);
  control::PolicyController controller(policy);
  put_decisions(controller);
  control::Planner planner(std::make_shared<const control::LearnedSimulator>(model), control::PlannerConfig{},
                           9);
  put_decisions(planner);
  put_steps(make_env(model, words[4], 50, 1));
}
