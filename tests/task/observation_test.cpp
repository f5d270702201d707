#include "lodestone/task/observation.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace lodestone::task;

namespace {

Observation example() {
  Observation observation;
  observation.pose = {0.0425, -0.02125, M_PI / 2.0};
  observation.target_m = {0.0, 0.02125};
  observation.last_action = {0.25, -1.0};
  observation.last_displacement_m = {0.0025, 0.005};
  return observation;
}

std::vector<float> encode(const EncoderConfig& config) {
  const ObservationEncoder encoder(config);
  std::vector<float> row(static_cast<std::size_t>(encoder.size()));
  encoder.encode(example(), row.data());
  return row;
}

}  // namespace

TEST_CASE("the paper's observation is x, y, theta and the target") {
  const auto row = encode({});
  REQUIRE(row.size() == 5);
  CHECK(row == std::vector<float>{1.0F, -0.5F, static_cast<float>(M_PI / 2.0), 0.0F, 0.5F});
}

TEST_CASE("every option adds its numbers in order") {
  EncoderConfig config;
  config.heading = "sine_cosine";
  config.relative_target = true;
  config.memory = true;
  const auto row = encode(config);
  REQUIRE(row.size() == 12);
  const std::vector<float> expected{1.0F,  -0.5F, 1.0F,  0.0F,  0.0F, 0.5F,
                                    -1.0F, 1.0F,  0.25F, -1.0F, 0.5F, 1.0F};
  for (std::size_t i = 0; i < row.size(); ++i) CHECK(row[i] == Approx(expected[i]).margin(1e-6));
  config.heading = "none";
  config.target = false;
  CHECK(encode(config).size() == 8);
}
