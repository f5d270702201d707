#include "lodestone/common/statistics.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "lodestone/common/error.h"

using namespace lodestone::common;

TEST_CASE("the median is the middle value, or lies between the two in the middle") {
  CHECK(median({3, 1, 100}) == 3.0);
  CHECK(median({4, 1, 2, 100}) == 3.0);
  CHECK(median({}) == 0.0);
}

TEST_CASE("the interquartile mean is that of the middle half") {
  CHECK(interquartile_mean({1, 2, 3, 4, 5, 6, 7, 1000}) == Approx(4.5));
  // five values: 1.25 to 3.75 of them, so the second and fourth count three quarters
  CHECK(interquartile_mean({5, 1, 2, 3, 100}) == Approx((0.75 * 2 + 3 + 0.75 * 5) / 2.5));
  CHECK(interquartile_mean({7}) == Approx(7.0));
  CHECK(interquartile_mean({}) == 0.0);
}

TEST_CASE("Wilson's interval agrees with the published example") {
  // Newcombe (1998), Statistics in Medicine 17: 81 of 263 and 15 of 148
  CHECK(wilson_interval(81, 263, 1.959964).low == Approx(0.2553).margin(1e-4));
  CHECK(wilson_interval(81, 263, 1.959964).high == Approx(0.3662).margin(1e-4));
  CHECK(wilson_interval(15, 148, 1.959964).low == Approx(0.0624).margin(1e-4));
  CHECK(wilson_interval(0, 20, 1.959964).high == Approx(0.1611).margin(1e-4));
  CHECK(wilson_interval(50, 50).low == Approx(0.9287).margin(1e-4));
  CHECK_THROWS_AS(wilson_interval(3, 2), LogicFault);
}

TEST_CASE("the bootstrap covers the mean about as often as it says") {
  int covered = 0;
  constexpr int kRuns = 300;
  for (int run = 0; run < kRuns; ++run) {
    RandomStream random(3, "values", static_cast<std::uint64_t>(run));
    std::vector<std::vector<double>> strata(5);
    for (auto& stratum : strata) {
      for (int i = 0; i < 20; ++i) stratum.push_back(2.0 + random.normal());
    }
    const Interval interval =
        bootstrap_interval(strata, mean, RandomStream(4, "bootstrap", static_cast<std::uint64_t>(run)), 400);
    if (interval.low <= 2.0 && interval.high >= 2.0) ++covered;
  }
  CHECK(covered > 0.90 * kRuns);
  CHECK(covered < 0.99 * kRuns);
}

TEST_CASE("strata keep their weights") {
  const std::vector<std::vector<double>> strata = {{1.0, 1.0, 1.0}, {3.0}, {}};
  const Interval interval = bootstrap_interval(strata, mean, RandomStream(1, "b"), 100);
  CHECK(interval.low == Approx(1.5));
  CHECK(interval.high == Approx(1.5));
}

TEST_CASE("percentiles, means and deviations") {
  CHECK(percentile({3, 1, 2}, 1.0) == 3.0);
  CHECK(median({3, 1, 2}) == 2.0);
  CHECK(percentile({}, 0.5) == 0.0);
  CHECK(standard_deviation({1, 2, 3}) == Approx(1.0));
  CHECK(standard_deviation({1}) == 0.0);
  CHECK(root_mean_square({3, 4}) == Approx(std::sqrt(12.5)));
  CHECK(root_mean_square({}) == 0.0);
}

TEST_CASE("the interval of a percentile holds it as often as it says") {
  std::mt19937 random(3);
  std::exponential_distribution<double> draw(1.0);
  const double truth = -std::log(0.1);  // the 90th percentile
  int held = 0;
  for (int round = 0; round < 1000; ++round) {
    std::vector<double> values(200);
    for (double& value : values) value = draw(random);
    const Interval interval = percentile_interval(values, 0.9);
    held += interval.low <= truth && truth <= interval.high ? 1 : 0;
  }
  CHECK(held >= 930);
  CHECK(held <= 985);
  const Interval few = percentile_interval({3.0, 1.0, 2.0}, 0.99);
  CHECK(few.high == 3.0);
  CHECK(percentile_interval({}, 0.5).high == 0.0);
}

TEST_CASE("groups that are drawn widen an interval by what differs between them") {
  using lodestone::common::mean;
  using lodestone::common::RandomStream;
  const std::vector<std::vector<double>> groups = {{1.0, 1.1, 0.9}, {2.0, 2.1, 1.9}, {3.0, 3.1, 2.9}};
  const Interval within = bootstrap_interval(groups, mean, RandomStream(1, "bootstrap"));
  const Interval nested = nested_bootstrap_interval(groups, mean, RandomStream(1, "bootstrap"));
  CHECK(within.high - within.low < 0.15);
  CHECK(nested.low < 1.5);
  CHECK(nested.high > 2.5);
  const std::vector<std::vector<double>> one = {{1.0, 2.0, 4.0}, {}};
  const Interval single = nested_bootstrap_interval(one, mean, RandomStream(2, "bootstrap"));
  CHECK(single.low == Approx(1.0));
  CHECK(single.high == Approx(4.0));
  CHECK(nested_bootstrap_interval({}, mean, RandomStream(1, "bootstrap")).high == 0.0);
}

TEST_CASE("the difference of two means has an interval that widens with their spread") {
  const std::vector<double> high = {5.0, 6.0, 7.0, 6.5, 5.5}, low = {1.0, 2.0, 3.0, 2.5, 1.5};
  const common::Interval apart = common::difference_interval(high, low, common::RandomStream(1, "draw"));
  CHECK(apart.low > 2.5);
  CHECK(apart.low < 4.0);
  CHECK(apart.high > 4.0);
  CHECK(apart.high < 5.5);
  const common::Interval none = common::difference_interval(high, high, common::RandomStream(1, "draw"));
  CHECK(none.low < 0.0);
  CHECK(none.high > 0.0);
  CHECK(common::difference_interval({}, low, common::RandomStream(1, "draw")).high == 0.0);
}

TEST_CASE("the signed-rank test counts every choice of signs, and shares ranks where sizes are equal") {
  // Heights of cross- and self-fertilised plants (Darwin, 1876): rank sums of 96 and 24.
  const std::vector<double> plants = {6, 8, 14, 16, 23, 24, 28, 29, 41, -48, 49, 56, 60, -67, 75};
  CHECK(common::signed_rank_p(plants) == Approx(0.041259765625).epsilon(1e-12));
  // Of ones, it is the sign test: two of ten below zero, 2 (1 + 10 + 45) / 1024.
  CHECK(common::signed_rank_p({1, 1, 1, 1, -1, 1, 1, -1, 1, 1, 0, 0}) == Approx(112.0 / 1024.0));
  CHECK(common::signed_rank_p({2.0}) == 1.0);
  CHECK(common::signed_rank_p({0.0, 0.0}) == 1.0);
  CHECK(common::signed_rank_p({}) == 1.0);
  CHECK(common::signed_rank_p({1, 2, 3, 4, 5}) == Approx(2.0 / 32.0));
}

TEST_CASE("where the signed-rank test becomes a normal one, its p hardly changes") {
  RandomStream random(3, "differences");
  std::vector<double> differences;
  for (int i = 0; i < 200; ++i) differences.push_back(std::round(10.0 * (random.normal() + 0.15)) / 10.0);
  differences.erase(std::remove(differences.begin(), differences.end(), 0.0), differences.end());
  const double exact = common::signed_rank_p(differences);
  CHECK(exact > 1e-4);
  CHECK(exact < 0.2);
  while (differences.size() <= 200) {  // as many on either side, smaller than all others
    differences.push_back(1e-6);
    differences.push_back(-1e-6);
  }
  CHECK(common::signed_rank_p(differences) == Approx(exact).epsilon(0.15));
}
