#include "lodestone/experiments/adaptation_run.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/files.h"
#include "lodestone/dynamics/model.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

experiments::AdaptationConfig little() {
  experiments::AdaptationConfig config;
  config.collection.sensor.kind = "simulated";
  config.collection.transitions = 160;
  config.collection.episode_steps = 6;
  config.planner.candidates = 16;
  config.planner.iterations = 1;
  config.model.hidden = {16};
  config.model.members = 2;
  config.model.components = 1;
  config.first.epochs = 6;
  config.learning.epochs = 2;
  return config;
}

runs::Adaptation adapt(const experiments::AdaptationConfig& config, const std::string& folder) {
  runs::RunFolder run({folder, "adapt", common::config_to_json(config), 1, true});
  experiments::AdaptationRun work(config, run,
                                  [&] { return experiments::make_exploration_session(config.collection); });
  return work.run();
}

std::string weights(const std::string& folder) {
  return common::read_file(folder + "/model/member_1.safetensors");
}

}  // namespace

TEST_CASE("a rig is learned from nothing, then gone on with, and threads change nothing") {
  const tests::TemporaryFolder folder;
  experiments::AdaptationConfig config = little();
  config.from_scratch = true;
  config.threads = 1;
  const runs::Adaptation scratch = adapt(config, folder / "scratch");
  CHECK(scratch.pulses == 160);
  CHECK(scratch.rig_minutes == Approx(0.8));
  CHECK(scratch.kept);
  CHECK(scratch.held_back > 0);
  CHECK(std::filesystem::exists(folder / "scratch/model/deploy.json"));
  CHECK_THROWS_AS(experiments::roll_back(folder / "scratch"), common::ConfigError);
  // Every stage is there already.
  CHECK(adapt(config, folder / "scratch").log_likelihood == scratch.log_likelihood);

  config = little();
  config.dynamics = folder / "scratch/model";
  config.collection.rig_seed = 2;
  config.threads = 1;
  const runs::Adaptation one = adapt(config, folder / "one");
  config.threads = 2;
  const runs::Adaptation two = adapt(config, folder / "two");
  CHECK(one.log_drive_gain.value() == two.log_drive_gain.value());
  CHECK(one.log_likelihood == two.log_likelihood);
  CHECK(weights(folder / "one") == weights(folder / "two"));
  CHECK((weights(folder / "one") == weights(folder / "scratch")) == !one.kept);
  // It remembers what the simulator had learned from.
  const dynamics::Model learned = dynamics::load_model(folder / "one/learning/checkpoint");
  const dynamics::Model from = dynamics::load_model(folder / "scratch/model");
  CHECK(learned.training_rows.state.shape()[0] > from.training_rows.state.shape()[0]);
}
