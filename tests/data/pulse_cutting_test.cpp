#include "lodestone/data/pulse_cutting.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;
using Catch::Matchers::Contains;
using data::LeftOut;

namespace {

/// Rows at these times with these drives along x; x moves by 1 mm a second.
std::vector<data::LogSample> log(const std::vector<std::pair<double, double>>& rows) {
  std::vector<data::LogSample> samples;
  for (const auto& [time_s, drive] : rows) {
    data::LogSample sample;
    sample.time_s = time_s;
    sample.pose.x_m = 1e-3 * time_s;
    sample.drive = {drive, 0.0};
    sample.line = static_cast<std::int64_t>(samples.size()) + 2;
    samples.push_back(sample);
  }
  return samples;
}

data::CutLog cut(const std::vector<std::pair<double, double>>& rows, double period_s = 0.0) {
  data::CuttingRule rule;
  rule.period_s = period_s;
  rule.same_drive = 0.5;
  return data::cut_pulses(log(rows), rule, "log.csv");
}

}  // namespace

TEST_CASE("one row for each pulse: the rows are the cuts, also where their distances vary") {
  const data::CutLog found = cut({{0.0, 5}, {0.3, 8}, {0.62, 8}, {0.9, 0}, {1.2, -3}, {1.5, 7}});
  CHECK(found.period_s == Approx(0.3));
  REQUIRE(found.pulses.size() == 5);
  CHECK(found.pulses[1].drive.x() == 8.0);
  CHECK(found.pulses[1].to_s == 0.62);
  CHECK(found.pulses[2].drive.x() == Approx(8.0));
  CHECK(found.pulses[3].drive.x() == 0.0);
  CHECK(found.pulses[4].after.x_m == Approx(1.5e-3));
  CHECK(found.pulses[4].line_after == 7);
  CHECK_FALSE(found.pulses[0].follows);
  CHECK(found.pulses[4].follows);
  CHECK(found.interpolated == 0);
  CHECK(found.left_out.empty());
}

TEST_CASE("a pulse of many rows ends where the current does, and a rest is as long as it is") {
  std::vector<std::pair<double, double>> rows;
  for (int i = 0; i <= 40; ++i)
    rows.emplace_back(0.05 * i, i >= 4 && i < 10 ? 6.0 : i >= 27 && i < 33 ? -9.0 : 0.0);
  const data::CutLog found = cut(rows);
  CHECK(found.period_s == Approx(0.3));
  REQUIRE(found.pulses.size() == 7);  // a rest of 0.2 s, a pulse, rests of together 0.85 s, a pulse, a rest
  CHECK(found.pulses[1].from_s == Approx(0.2));
  CHECK(found.pulses[1].to_s == Approx(0.5));
  CHECK(found.pulses[1].drive.x() == 6.0);
  CHECK(found.pulses[2].to_s == Approx(0.8));
  CHECK(found.pulses[4].to_s == Approx(1.35));
  CHECK(found.pulses[5].drive.x() == -9.0);
}

TEST_CASE("a current on its way counts to what it becomes, and not to its mean") {
  const data::CutLog found =
      cut({{0.0, 0}, {0.1, 3}, {0.13, 9}, {0.25, 9}, {0.4, 4}, {0.44, 0}, {0.6, 0}}, 0.3);
  REQUIRE(found.pulses.size() == 3);
  CHECK(found.pulses[1].from_s == 0.1);
  CHECK(found.pulses[1].to_s == 0.4);
  CHECK(found.pulses[1].drive.x() == Approx(9.0));
  CHECK(found.pulses[2].drive.x() == 0.0);
}

TEST_CASE("a long drive is cut every pulse, between rows where none is near") {
  const data::CutLog found =
      cut({{0.0, 6}, {0.13, 6}, {0.26, 6}, {0.38, 6}, {0.52, 6}, {0.66, 6}, {0.7, 0}, {0.85, 0}}, 0.2);
  REQUIRE(found.pulses.size() == 4);
  CHECK(found.interpolated > 0);
  CHECK(found.pulses[0].to_s == Approx(0.2));
  CHECK(found.pulses[0].after.x_m == Approx(0.2e-3));
  REQUIRE(found.left_out.size() == 1);
  CHECK(found.left_out[0].why == LeftOut::kRemainder);
  CHECK(found.left_out[0].to_s == 0.7);
  CHECK_FALSE(found.pulses[3].follows);
}

TEST_CASE("rows that are too far apart are not connected, and short pulses are left out") {
  const data::CutLog found = cut({{0.0, 6}, {0.3, 7}, {0.6, 6}, {2.0, 6}, {2.3, 8}, {2.4, 0}, {2.7, 0}}, 0.3);
  REQUIRE(found.pulses.size() == 4);
  CHECK(found.longest_gap_s == Approx(0.45));
  CHECK_FALSE(found.pulses[2].follows);
  CHECK_FALSE(found.pulses[3].follows);
  REQUIRE(found.left_out.size() == 2);
  CHECK(found.left_out[0].why == LeftOut::kGap);
  CHECK(found.left_out[0].line == 4);
  CHECK(found.left_out[1].why == LeftOut::kOtherLength);
  CHECK(found.left_out[1].from_s == 2.3);
}

TEST_CASE("a current that is on for a part of each step is one step with its rest") {
  std::vector<std::pair<double, double>> rows;
  for (int i = 0; i <= 60; ++i) {  // 0.1 s of every 0.3 s, the last but one for 0.2 s; then a long rest
    const bool on = i < 48 && (i % 12 < 4 || (i >= 24 && i < 32));
    rows.emplace_back(0.025 * i, on ? 5.0 + i / 12 : 0.0);
  }
  data::CuttingRule rule;
  rule.same_drive = 0.5;
  rule.on_s = 0.1;
  const data::CutLog found = data::cut_pulses(log(rows), rule, "log.csv");
  CHECK(found.period_s == Approx(0.3));
  REQUIRE(found.pulses.size() == 5);  // two steps, the rest of the long one, a step, a rest
  CHECK(found.pulses[0].drive.x() == Approx(5.0));
  CHECK(found.pulses[0].to_s == Approx(0.3));
  CHECK(found.pulses[1].follows);
  CHECK(found.pulses[1].drive.x() == Approx(6.0));
  CHECK(found.pulses[2].from_s == Approx(0.8));
  CHECK(found.pulses[2].drive.x() == 0.0);
  CHECK(found.pulses[3].drive.x() == Approx(8.0));
  CHECK(found.pulses[3].to_s == Approx(1.2));
  CHECK(found.pulses[4].to_s == Approx(1.5));
  REQUIRE(found.left_out.size() == 1);
  CHECK(found.left_out[0].why == LeftOut::kOtherLength);
}

TEST_CASE("headings between rows are taken the short way round") {
  auto samples = log({{0.0, 6}, {0.14, 6}, {0.29, 6}, {0.4, 6}});
  samples[1].pose.heading_rad = 3.1;
  samples[2].pose.heading_rad = -3.1;
  data::CuttingRule rule;
  rule.period_s = 0.2;
  rule.tolerance = 0.05;
  const data::CutLog found = data::cut_pulses(samples, rule, "log.csv");
  REQUIRE(found.pulses.size() == 2);
  CHECK(std::abs(found.pulses[0].after.heading_rad) > 3.1);
}

TEST_CASE("logs that hold no pulse, or whose times cannot be, are refused") {
  CHECK_THROWS_WITH(cut({{0.0, 5}}), Contains("log.csv: holds no two rows"));
  CHECK_THROWS_WITH(cut({{0.0, 0}, {0.3, 0}, {0.6, 0}}), Contains("no row has a current"));
  CHECK_THROWS_WITH(cut({{0.0, 5}, {300.0, 8}, {600.0, 7}}), Contains("correct the unit of time"));
  CHECK_THROWS_WITH(cut({{0.0, 5}, {3e-4, 8}, {6e-4, 7}}), Contains("correct the unit of time"));
  std::vector<std::pair<double, double>> rows;
  for (int i = 0; i < 3000; ++i) rows.emplace_back(40.0 * i, 5.0);
  CHECK_THROWS_WITH(cut(rows, 1e-3), Contains("correct control_period_s"));
}
