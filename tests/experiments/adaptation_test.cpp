#include "lodestone/experiments/adaptation.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "env/linear_model.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/random.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// A simulator that says so many metres per ampere.
experiments::SimulatorSource straight_simulator(double m_per_A) {
  experiments::SimulatorSource source;
  source.simulator =
      std::make_shared<const control::LearnedSimulator>(env::tests::noisy_linear_model(m_per_A));
  source.action = source.simulator->action;
  return source;
}

/// Pulses on a rig that goes so far for an ampere; one of ten has no current.
data::Dataset recorded_on(double m_per_A, int episodes, std::uint64_t seed) {
  common::RandomStream random(seed, "recorded");
  data::Dataset dataset;
  for (int e = 0; e < episodes; ++e) {
    data::Episode episode;
    double x_m = 0.001 * random.normal(), y_m = 0.001 * random.normal();
    for (const double value : {x_m, y_m, 0.1}) episode.observations.push_back(value);
    for (int t = 0; t < 10; ++t) {
      const bool zero = t == 4;
      const double drive_A[2] = {zero ? 0.0 : random.uniform(-5.0, 5.0),
                                 zero ? 0.0 : random.uniform(-5.0, 5.0)};
      x_m += m_per_A * drive_A[0] + env::tests::kLinearNoise_m * random.normal();
      y_m += m_per_A * drive_A[1] + env::tests::kLinearNoise_m * random.normal();
      episode.observations.insert(episode.observations.end(), {x_m, y_m, 0.1});
      episode.actions.insert(episode.actions.end(), {drive_A[0], drive_A[1]});
      episode.terminations.push_back(0);
      episode.truncations.push_back(t == 9 ? 1 : 0);
      episode.zero_current.push_back(zero ? 1 : 0);
    }
    dataset.episodes.push_back(std::move(episode));
  }
  return dataset;
}

constexpr double kKnown_m = 0.5e-3;  // per ampere

void write_text(const std::string& folder, const std::string& text) {
  common::make_folders(folder);
  common::write_file_atomically(folder + "/is", text);
}

}  // namespace

TEST_CASE("the gain is found from a recording, and pulses are explained best at it") {
  const experiments::SimulatorSource simulator = straight_simulator(kKnown_m);
  const data::Dataset recorded = recorded_on(1.6 * kKnown_m, 4, 1);
  const task::DriveGain gain = experiments::identify(simulator, {}, recorded);
  CHECK(gain.log_mean == Approx(std::log(1.6)).margin(0.03));
  CHECK(gain.log_sigma < 0.05);
  const auto at_gain = experiments::explain(simulator, {}, recorded, gain.log_mean);
  const auto at_one = experiments::explain(simulator, {}, recorded, 0.0);
  REQUIRE(at_gain.size() == 4);
  REQUIRE(at_gain.front().size() == 9);  // one pulse had no current
  for (std::size_t e = 0; e < 4; ++e)
    CHECK(std::accumulate(at_gain[e].begin(), at_gain[e].end(), 0.0) >
          std::accumulate(at_one[e].begin(), at_one[e].end(), 0.0) + 1.0);
}

TEST_CASE("what was learned is kept only where it explains more than the gain does") {
  const experiments::SimulatorSource before = straight_simulator(kKnown_m);
  const auto adapted = [&](double rig, double learned) {
    return experiments::compare(&before, straight_simulator(learned * kKnown_m), {},
                                recorded_on(rig * kKnown_m, 8, 2), recorded_on(rig * kKnown_m, 8, 3));
  };
  // The gain says all there is to say.
  const runs::Adaptation right = adapted(1.5, 1.5);
  CHECK(right.held_back == 72);
  CHECK(right.log_drive_gain.value() == Approx(std::log(1.5)).margin(0.03));
  CHECK(right.log_likelihood_with_gain.value() > right.log_likelihood_before.value() + 1.0);
  CHECK(right.log_likelihood == Approx(right.log_likelihood_with_gain.value()).margin(0.2));
  // Worse than that.
  const runs::Adaptation wrong = adapted(1.5, 1.0);
  CHECK_FALSE(wrong.kept);
  CHECK(wrong.better_by.value() < 0.0);
  // A rig five times as strong is none of the gains that are thought possible.
  const runs::Adaptation beyond = adapted(5.0, 5.0);
  CHECK(beyond.kept);
  CHECK(beyond.better_by_low.value() > 0.0);
  const runs::Adaptation scratch = experiments::compare(nullptr, before, {}, {}, recorded_on(kKnown_m, 2, 4));
  CHECK(scratch.kept);
  CHECK_FALSE(scratch.better_by);
}

TEST_CASE("a simulator takes the place of another, and gives it back once") {
  const tests::TemporaryFolder folder;
  write_text(folder / "old", "old");
  write_text(folder / "new", "new");
  const std::string run = folder / "run";
  common::make_folders(run);
  CHECK_THROWS_WITH(experiments::roll_back(run), Catch::Contains("no adaptation"));
  common::write_artefact(run + "/adaptation.json", runs::Adaptation{});
  experiments::put_model(run, folder / "old");
  CHECK_THROWS_AS(experiments::roll_back(run), common::ConfigError);
  experiments::keep_before(run, folder / "old");
  experiments::put_model(run, folder / "new");
  CHECK(common::read_file(run + "/model/is") == "new");
  CHECK(std::filesystem::exists(run + "/model/deploy.json"));
  experiments::roll_back(run);
  CHECK(common::read_file(run + "/model/is") == "old");
  CHECK(common::read_artefact<runs::Adaptation>(run + "/adaptation.json").rolled_back);
  CHECK_THROWS_AS(experiments::roll_back(run), common::ConfigError);
  CHECK_FALSE(std::filesystem::exists(run + "/model.tmp"));
}
