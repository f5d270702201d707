#include "lodestone/dynamics/region_coverage.h"

#include <catch2/catch.hpp>
#include <cmath>

#include <ATen/ATen.h>

#include "lodestone/common/random.h"
#include "lodestone/common/statistics.h"
#include "lodestone/dynamics/network.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/inference/mixture.h"
#include "lodestone/nets/tensors.h"

namespace lodestone::dynamics {
namespace {

/// One Gaussian of a change of position (m, m) or of pose (m, m, rad).
struct Part {
  double weight;
  std::vector<double> mean;
  std::vector<double> spread;
};
using Parts = std::vector<Part>;

/// What a network has to put out for a mixture, in units of `unit`.
std::vector<double> raw_numbers(const Parts& parts, const std::vector<double>& unit) {
  std::vector<double> raw;
  for (const Part& part : parts) raw.push_back(std::log(part.weight));
  for (const Part& part : parts)
    for (std::size_t i = 0; i < unit.size(); ++i) raw.push_back(part.mean[i] / unit[i]);
  for (const Part& part : parts)
    for (std::size_t i = 0; i < unit.size(); ++i) {
      const double share = (std::log(part.spread[i] / unit[i]) - inference::kLeastLogSpread) /
                           (inference::kMostLogSpread - inference::kLeastLogSpread);
      raw.push_back(std::log(share / (1.0 - share)));
    }
  return raw;
}

/// Each of its members always predicts the same mixture of changes.
Model mixture_model(data::StateLayout layout, const std::vector<Parts>& members) {
  const at::NoGradGuard no_grad;
  Model model;
  model.config.form = inference::DynamicsForm::kDelta;
  model.config.hidden = {4};
  model.config.batch_norm = false;
  model.config.members = static_cast<std::int64_t>(members.size());
  model.config.components = static_cast<std::int64_t>(members.front().size());
  model.info.layout = layout;
  model.members = make_members(model.config, layout, 1);
  std::vector<double> unit = {0.01, 0.01, 1.0};
  unit.resize(static_cast<std::size_t>(data::state_size(layout)));
  for (std::size_t m = 0; m < members.size(); ++m) {
    std::vector<at::Tensor> parameters = model.members[m]->tensors().parameters();
    for (at::Tensor& parameter : parameters) parameter.zero_();
    const std::vector<double> raw = raw_numbers(members[m], unit);
    parameters.back().copy_(nets::tensor_from(raw, {static_cast<std::int64_t>(raw.size())}, at::kFloat));
    model.members[m]->output_std.copy_(nets::tensor_from(unit, {static_cast<std::int64_t>(unit.size())}));
  }
  return model;
}

/// Motions of which each is drawn from one of the mixtures.
data::TransitionTable drawn_rows(const std::vector<Parts>& mixtures, std::int64_t rows, std::uint64_t seed) {
  common::RandomStream random(seed, "drawn rows");
  data::TransitionTable table;
  table.state_size = static_cast<int>(mixtures.front().front().mean.size());
  for (std::int64_t row = 0; row < rows; ++row) {
    const Parts& parts = mixtures[random.below(mixtures.size())];
    double left = random.uniform();
    std::size_t chosen = 0;
    while (chosen + 1 < parts.size() && left >= parts[chosen].weight) left -= parts[chosen++].weight;
    for (std::size_t i = 0; i < parts[chosen].mean.size(); ++i) {
      const double reach = i == 2 ? geometry::kPi : 0.03;
      const double state = random.uniform(-reach, reach);
      const double next = state + parts[chosen].mean[i] + parts[chosen].spread[i] * random.normal();
      table.state.push_back(state);
      table.next_state.push_back(i == 2 ? geometry::wrap_angle(next) : next);
    }
    table.action.insert(table.action.end(), {1.0, -2.0});
    table.episode.push_back(row);
  }
  return table;
}

std::vector<Parts> scaled(std::vector<Parts> mixtures, double factor) {
  for (Parts& parts : mixtures)
    for (Part& part : parts)
      for (double& spread : part.spread) spread *= factor;
  return mixtures;
}

/// Four standard errors of a share of so many.
double margin(double share, std::int64_t rows) {
  return 4.0 * std::sqrt(share * (1.0 - share) / static_cast<double>(rows));
}

constexpr std::int64_t kMotions = 2000;
const std::vector<Parts> kOneGaussian = {{{1.0, {3e-3, -2e-3}, {1e-3, 2e-3}}}};
/// Two members: of rest or a jump, and of turns that often lead across the cut of the circle.
const std::vector<Parts> kPoseMixtures = {
    {{0.4, {0.0, 0.0, 0.0}, {2e-4, 2e-4, 0.02}}, {0.6, {6e-3, 1e-3, 1.2}, {1e-3, 2e-3, 0.3}}},
    {{0.7, {4e-3, 0.0, 0.8}, {3e-3, 1e-3, 1.5}}, {0.3, {-5e-3, 2e-3, -0.9}, {1e-3, 1e-3, 0.2}}}};

TEST_CASE("regions of a model that is right hold as many motions as they should", "[unit]") {
  const auto check = [](const runs::RegionCoverage::ByPercent& shares) {
    REQUIRE(shares.size() == 3);
    for (const int percent : {50, 90, 99}) {
      CAPTURE(percent);
      const runs::CoveredFraction& covered = shares.at(percent);
      CHECK(std::abs(covered.fraction - 0.01 * percent) < margin(0.01 * percent, kMotions));
      const auto count = static_cast<std::int64_t>(std::llround(covered.fraction * kMotions));
      CHECK(covered.interval[0] == Approx(common::wilson_interval(count, kMotions).low));
      CHECK(covered.interval[1] == Approx(common::wilson_interval(count, kMotions).high));
    }
  };
  const auto position = region_coverage(mixture_model(data::StateLayout::kPosition, kOneGaussian),
                                        drawn_rows(kOneGaussian, kMotions, 1));
  REQUIRE(position.has_value());
  CHECK(position->n == kMotions);
  CHECK_FALSE(position->pose.has_value());
  check(position->position);
  const auto pose = region_coverage(mixture_model(data::StateLayout::kPose, kPoseMixtures),
                                    drawn_rows(kPoseMixtures, kMotions, 2));
  REQUIRE(pose.has_value());
  REQUIRE(pose->pose.has_value());
  check(pose->position);
  check(*pose->pose);
}

TEST_CASE("regions of a model that is twice too sure of itself hold too few", "[unit]") {
  const auto position =
      region_coverage(mixture_model(data::StateLayout::kPosition, scaled(kOneGaussian, 0.5)),
                      drawn_rows(kOneGaussian, kMotions, 3));
  const auto pose = region_coverage(mixture_model(data::StateLayout::kPose, scaled(kPoseMixtures, 0.5)),
                                    drawn_rows(kPoseMixtures, kMotions, 4));
  REQUIRE(position.has_value());
  REQUIRE(pose.has_value());
  REQUIRE(pose->pose.has_value());
  for (const int percent : {50, 90, 99}) {
    CAPTURE(percent);
    // Of one Gaussian in a plane: its region ends where 1 - p = exp(-r^2 / 2), and is half as wide here. A
    // thousand draws place that end well enough for a hundredth.
    const double expected = 1.0 - std::pow(1.0 - 0.01 * percent, 0.25);
    CHECK(std::abs(position->position.at(percent).fraction - expected) < margin(expected, kMotions) + 0.01);
    for (const auto* shares : {&position->position, &pose->position, &*pose->pose})
      CHECK(shares->at(percent).interval[1] < 0.01 * percent);
  }
}

TEST_CASE("regions of a model that is twice too unsure hold too many", "[unit]") {
  const auto coverage =
      region_coverage(mixture_model(data::StateLayout::kPosition, scaled(kOneGaussian, 2.0)),
                      drawn_rows(kOneGaussian, kMotions, 5));
  REQUIRE(coverage.has_value());
  for (const int percent : {50, 90}) CHECK(coverage->position.at(percent).interval[0] > 0.01 * percent);
}

TEST_CASE("a position is judged wherever the heading went", "[unit]") {
  const std::vector<Parts> seen = {{{1.0, {3e-3, 0.0, 0.1}, {1e-3, 1e-3, 0.2}}}};
  const std::vector<Parts> expected = {{{1.0, {3e-3, 0.0, 3.0}, {1e-3, 1e-3, 0.2}}}};
  const auto coverage =
      region_coverage(mixture_model(data::StateLayout::kPose, expected), drawn_rows(seen, kMotions, 6));
  REQUIRE(coverage.has_value());
  CHECK(std::abs(coverage->position.at(90).fraction - 0.9) < margin(0.9, kMotions));
  CHECK(coverage->pose.value().at(99).fraction == 0.0);
}

TEST_CASE("single values have no regions, and of very many rows some are taken", "[unit]") {
  Model model = mixture_model(data::StateLayout::kPosition, kOneGaussian);
  CHECK(region_coverage(model, drawn_rows(kOneGaussian, 25000, 7)).value().n == 8334);
  model.config.components = 0;
  CHECK_FALSE(region_coverage(model, drawn_rows(kOneGaussian, 10, 7)).has_value());
}

}  // namespace
}  // namespace lodestone::dynamics
