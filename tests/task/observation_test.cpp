#include "lodestone/task/observation.h"
#include "lodestone/geometry/angle.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "lodestone/common/statistics.h"
#include "paper_rig.h"

using namespace lodestone::task;

namespace {

Observation example() {
  Observation observation;
  observation.pose = {0.0425, -0.02125, lodestone::geometry::kPi / 2.0};
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
  const auto row = encode(lodestone::tests::paper_encoder());
  REQUIRE(row.size() == 5);
  CHECK(row ==
        std::vector<float>{1.0F, -0.5F, static_cast<float>(lodestone::geometry::kPi / 2.0), 0.0F, 0.5F});
}

TEST_CASE("every option adds its numbers in order") {
  EncoderConfig config = lodestone::tests::paper_encoder();
  config.heading = HeadingEncoding::kSineCosine;
  config.relative_target = true;
  config.memory = true;
  const auto row = encode(config);
  REQUIRE(row.size() == 12);
  const std::vector<float> expected{1.0F,  -0.5F, 1.0F,  0.0F,  0.0F, 0.5F,
                                    -1.0F, 1.0F,  0.25F, -1.0F, 0.5F, 1.0F};
  for (std::size_t i = 0; i < row.size(); ++i) CHECK(row[i] == Approx(expected[i]).margin(1e-6));
  config.heading = HeadingEncoding::kNone;
  config.target = false;
  CHECK(encode(config).size() == 8);
}

TEST_CASE("an encoded row can be read back and given another target") {
  EncoderConfig config = lodestone::tests::paper_encoder();
  config.heading = HeadingEncoding::kSineCosine;
  config.relative_target = true;
  config.target_heading = true;
  config.memory = true;
  const ObservationEncoder encoder(config);
  std::vector<float> row = encode(config);
  const Observation seen = example();
  CHECK((encoder.position_m(row.data()) - seen.pose.position_m()).norm() < 1e-8);
  CHECK(encoder.target_distance_m(row.data()) == Approx((seen.target_m - seen.pose.position_m()).norm()));
  Observation other = seen;
  other.target_m = {0.01, -0.02};
  encoder.retarget(other.target_m, row.data());
  std::vector<float> expected(row.size());
  encoder.encode(other, expected.data());
  for (std::size_t i = 0; i < row.size(); ++i) CHECK(row[i] == Approx(expected[i]).margin(1e-6));
}

TEST_CASE("what is near the target gets more room, and can be read back") {
  EncoderConfig config = lodestone::tests::paper_encoder();
  config.heading = HeadingEncoding::kNone;
  config.target = false;
  config.relative_target = true;
  config.fine_distance_m = 2e-4;
  const ObservationEncoder encoder(config);
  REQUIRE(encoder.size() == 5);
  Observation seen;
  std::vector<float> row(5);
  const auto third = [&](double distance_m) {
    seen.target_m = {0.0, distance_m};
    encoder.encode(seen, row.data());
    CHECK(encoder.target_distance_m(row.data()) == Approx(distance_m).epsilon(1e-4));
    return row[4];
  };
  CHECK(third(0.0) == 0.0F);
  CHECK(third(2e-4) == Approx(std::log(2.0) / std::log1p(config.length_scale_m / 2e-4)));
  CHECK(third(config.length_scale_m) == Approx(1.0));
  CHECK(row[2] == Approx(0.0).margin(1e-6));
  CHECK(row[3] == Approx(1.0).epsilon(1e-3));  // all of the direction
  encoder.retarget({-0.003, 0.004}, row.data());
  CHECK(encoder.target_distance_m(row.data()) == Approx(0.005).epsilon(1e-4));
}

TEST_CASE("a policy may be told the drive's gain, and where its target will be") {
  EncoderConfig config = lodestone::tests::paper_encoder();
  config.heading = HeadingEncoding::kNone;
  config.drive_gain = true;
  config.target_ahead = true;
  const ObservationEncoder encoder(config);
  Observation seen;
  seen.target_m = {0.01, 0.0};
  seen.ahead = {{{0.02, 0.0}, 0.3}, {{0.03, 0.0}, 0.6}};
  std::vector<float> row(static_cast<std::size_t>(encoder.size()));
  encoder.encode(seen, row.data());
  CHECK(encoder.target_distance_m(row.data()) == Approx(0.02));
  CHECK(row[4] == 0.0F);  // nothing is known
  CHECK(row[5] == 0.0F);
  seen.drive_gain = DriveGain{0.3, 0.05};
  encoder.encode(seen, row.data());
  CHECK(row[4] == Approx(0.3));
  CHECK(row[5] == Approx(0.05));
}

TEST_CASE("an estimate of a gain and what is left to it together have the gain's own spread") {
  lodestone::common::RandomStream random(2, "gains");
  std::vector<double> gain;
  double least = 1.0, most = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const DriveGain estimate = draw_gain_estimate(0.4, 0.05, random);
    least = std::min(least, estimate.log_sigma);
    most = std::max(most, estimate.log_sigma);
    gain.push_back(estimate.log_mean + estimate.log_sigma * random.normal());
  }
  CHECK(lodestone::common::mean(gain) == Approx(0.0).margin(0.01));
  CHECK(lodestone::common::standard_deviation(gain) == Approx(0.4).margin(0.01));
  CHECK(least == Approx(0.05).epsilon(0.01));
  CHECK(most == Approx(0.4).epsilon(0.01));
  const DriveGain nothing = draw_gain_estimate(0.0, 0.05, random);  // rigs that do not differ
  CHECK(nothing.log_mean == 0.0);
  CHECK(nothing.log_sigma == 0.0);
}

TEST_CASE("the target is known as far ahead as the way is told, and where it is without one", "[unit]") {
  Observation observation;
  observation.target_m = {0.01, 0.0};
  CHECK(observation.target_after_m(3) == observation.target_m);
  observation.ahead = {{{0.02, 0.0}, 0.3}, {{0.03, 0.0}, 0.6}};
  CHECK(observation.target_after_m(0).x() == 0.01);
  CHECK(observation.target_after_m(1).x() == 0.02);
  CHECK(observation.target_after_m(2).x() == 0.03);
  CHECK(observation.target_after_m(9).x() == 0.03);
}

TEST_CASE("so is how the needle shall lie", "[unit]") {
  Observation observation;
  observation.ahead = {{{0.02, 0.0}, 0.3}, {{0.03, 0.0}, 0.6}};
  CHECK_FALSE(observation.target_heading_after_rad(1));
  observation.target_heading_rad = 0.5;
  CHECK(observation.target_heading_after_rad(2) == 0.5);  // one for all of it
  observation.ahead = {{{0.02, 0.0}, 0.3, 0.6}, {{0.03, 0.0}, 0.6, 0.7}};
  CHECK(observation.target_heading_after_rad(0) == 0.5);
  CHECK(observation.target_heading_after_rad(1) == 0.6);
  CHECK(observation.target_heading_after_rad(9) == 0.7);
}

TEST_CASE("a policy is told the heading of the target that it is told") {
  EncoderConfig config = lodestone::tests::paper_encoder();
  config.heading = HeadingEncoding::kNone;
  config.target_heading = true;
  Observation seen;
  seen.pose.heading_rad = 0.25;
  seen.target_heading_rad = 0.5;
  seen.ahead.push_back({{0.02, 0.0}, 0.3, 1.0});
  std::vector<float> row(6);
  REQUIRE(ObservationEncoder(config).size() == 6);
  ObservationEncoder(config).encode(seen, row.data());
  CHECK(row[4] == Approx(std::sin(0.25)));
  config.target_ahead = true;
  ObservationEncoder(config).encode(seen, row.data());
  CHECK(row[4] == Approx(std::sin(0.75)));
  CHECK(row[5] == Approx(std::cos(0.75)));
}
