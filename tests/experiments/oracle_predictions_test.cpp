#include "lodestone/experiments/oracle_predictions.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "sphere_rig.h"

using namespace lodestone;

namespace {

experiments::CollectionConfig sensed_without_camera() {
  experiments::CollectionConfig config;
  config.sensor.kind = "simulated";
  return config;
}

data::Dataset recorded_of(const experiments::CollectionConfig& config, std::int64_t episodes) {
  experiments::Collection collection(config);
  data::Dataset dataset;
  dataset.info = experiments::dataset_info(config);
  while (static_cast<std::int64_t>(dataset.episodes.size()) < episodes)
    dataset.episodes.push_back(collection.next_episode(12));
  return dataset;
}

runs::DynamicsBaselines foretold_by(const experiments::CollectionConfig& config, const data::Dataset& dataset,
                                    std::size_t threads = 2) {
  runs::DynamicsBaselines baselines;
  common::ThreadPool pool(threads);
  experiments::add_oracle(config, dataset, 8, pool, baselines);
  return baselines;
}

/// Of a needle that is said not to move.
double no_motion_mm(const data::Dataset& dataset) {
  double square_m2 = 0.0;
  std::int64_t count = 0;
  for (const data::Episode& episode : dataset.episodes)
    for (std::int64_t t = 0; t < episode.length(); ++t) {
      if (episode.zero_current[static_cast<std::size_t>(t)] != 0) continue;
      const double* state = &episode.observations[static_cast<std::size_t>(3 * t)];
      square_m2 += std::pow(state[3] - state[0], 2) + std::pow(state[4] - state[1], 2);
      ++count;
    }
  return 1e3 * std::sqrt(square_m2 / static_cast<double>(count));
}

}  // namespace

TEST_CASE("the rig itself foretells its pulses better than anybody, and worse the further ahead") {
  const experiments::CollectionConfig config = sensed_without_camera();
  const data::Dataset dataset = recorded_of(config, 12);
  const runs::DynamicsBaselines baselines = foretold_by(config, dataset);
  REQUIRE(baselines.oracle);
  CHECK(baselines.oracle->position_rms_mm > 0.05);  // the sensor's noise, at least
  CHECK(baselines.oracle->position_rms_mm < 0.4 * no_motion_mm(dataset));
  REQUIRE(baselines.oracle->heading_rms_deg);
  CHECK(*baselines.oracle->heading_rms_deg < 40.0);
  const auto& ahead_mm = *baselines.oracle_open_loop->k_step_mm;
  CHECK(*ahead_mm.at(10) > *ahead_mm.at(1));
  CHECK(ahead_mm.size() == 4);
  const runs::DynamicsBaselines alone = foretold_by(config, dataset, 1);
  CHECK(alone.oracle->position_rms_mm == baselines.oracle->position_rms_mm);
  CHECK(*alone.oracle_open_loop->k_step_heading_deg == *baselines.oracle_open_loop->k_step_heading_deg);
  experiments::CollectionConfig other = config;
  other.rig.needle.moment_A_m2 *= 0.5;  // that is not the rig
  CHECK(foretold_by(other, dataset).oracle->position_rms_mm > 1.3 * baselines.oracle->position_rms_mm);
}

TEST_CASE("what no twin can be made of is refused") {
  experiments::CollectionConfig config = sensed_without_camera();
  data::Dataset dataset = recorded_of(config, 1);
  config.rig.backend = rig::Backend::kSerial;
  CHECK_THROWS_WITH(foretold_by(config, dataset), Catch::Contains("rig.backend"));
  config.rig.backend = rig::Backend::kVirtual;
  dataset.info.action_unit = "percent";
  CHECK_THROWS_AS(foretold_by(config, dataset), common::DataError);
  dataset.info.action_unit = "A";
  dataset.episodes.clear();
  CHECK_THROWS_AS(foretold_by(config, dataset), common::DataError);
  config.rig.needle = tests::sphere();
  CHECK_THROWS_WITH(foretold_by(config, dataset), Catch::Contains("rig.needle.shape"));
}
