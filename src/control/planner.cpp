#include "lodestone/control/planner.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::control {
namespace {

/// What lying outside the dish costs beyond the distance: more than any way inside.
constexpr double kOutside_mm = 100.0;
/// The search never narrows down further than this, or it would stop looking.
constexpr double kLeastSpread = 0.02;

}  // namespace

void PlannerConfig::validate() const {
  if (elites > candidates)
    throw common::InvalidConfig("elites", elites, fmt::format("not exceed candidates = {}", candidates));
}

Planner::Planner(std::shared_ptr<const LearnedSimulator> model, const PlannerConfig& config,
                 std::uint64_t seed)
    : model_(std::move(model)), config_(config), seed_(seed), random_(seed, "planner") {
  config_.validate();
  const auto particles = std::max(static_cast<std::size_t>(config_.particles), model_->members.size());
  for (std::size_t k = 0; k < particles; ++k)
    quantile_.push_back(
        common::normal_quantile((static_cast<double>(k) + 0.5) / static_cast<double>(particles)));
  reset();
}

void Planner::reset() {
  random_ = common::RandomStream(seed_, "planner");
  plan_.assign(static_cast<std::size_t>(config_.horizon), geometry::Drive::Zero(model_->action.size));
}

std::vector<std::size_t> Planner::best(std::size_t count) const {
  std::vector<std::size_t> order(candidates_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  count = std::min(count, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                    [this](std::size_t a, std::size_t b) {
                      return cost_mm_[a] != cost_mm_[b] ? cost_mm_[a] < cost_mm_[b] : a < b;
                    });
  order.resize(count);
  return order;
}

geometry::Drive Planner::act(const task::Observation& observation) {
  const auto horizon = static_cast<std::size_t>(config_.horizon);
  const int numbers = model_->action.size;
  const Sequence nothing(horizon, geometry::Drive::Zero(numbers));
  // What was the second pulse is the first one now, and one proposal among others.
  std::rotate(plan_.begin(), plan_.begin() + 1, plan_.end());
  plan_.back().setZero();
  Sequence mean = nothing;
  Sequence spread(horizon, geometry::Drive::Constant(numbers, config_.spread));
  std::vector<Sequence> elites;
  for (std::int64_t iteration = 0; iteration < config_.iterations; ++iteration) {
    candidates_ = {nothing, plan_, mean};
    while (candidates_.size() < static_cast<std::size_t>(config_.candidates)) {
      Sequence& candidate = candidates_.emplace_back(mean);
      for (std::size_t t = 0; t < horizon; ++t) {
        const geometry::Drive noise = geometry::drawn_drive(numbers, [this] { return random_.normal(); });
        candidate[t] = geometry::saturated(candidate[t] + spread[t].cwiseProduct(noise));
      }
    }
    evaluate_candidates(observation);
    elites.clear();
    for (const std::size_t index : best(static_cast<std::size_t>(config_.elites)))
      elites.push_back(candidates_[index]);
    for (std::size_t t = 0; t < horizon; ++t) {
      geometry::Drive sum = geometry::Drive::Zero(numbers);
      geometry::Drive square = geometry::Drive::Zero(numbers);
      for (const Sequence& elite : elites) {
        sum += elite[t];
        square += elite[t].cwiseProduct(elite[t]);
      }
      mean[t] = sum / static_cast<double>(elites.size());
      square /= static_cast<double>(elites.size());
      spread[t] = (square - mean[t].cwiseProduct(mean[t])).cwiseMax(kLeastSpread * kLeastSpread).cwiseSqrt();
    }
  }
  // The best of many was lucky, and the mean of two good ways may lie on neither: judged once more.
  candidates_ = std::move(elites);
  candidates_.push_back(mean);
  candidates_.push_back(nothing);
  evaluate_candidates(observation);
  plan_ = candidates_[best(1).front()];
  return plan_.front();
}

void Planner::evaluate_candidates(const task::Observation& observation) {
  const std::size_t count = candidates_.size();
  const std::size_t members = model_->members.size();
  const bool alike = !observation.drive_gain && !model_->sampled;
  const std::size_t particles = alike ? members : quantile_.size();
  const task::DriveGain gain = observation.drive_gain.value_or(task::DriveGain{});
  const double limit = model_->action.scale;
  const std::size_t size = model_->state_size;
  const std::size_t rows = count * particles;
  state_.resize(rows * size);
  next_.resize(rows * size);
  const auto numbers = static_cast<std::size_t>(model_->action.size);
  drive_.resize(numbers * rows);
  for (std::size_t row = 0; row < rows; ++row) {
    state_[row * size] = observation.pose.x_m;
    state_[row * size + 1] = observation.pose.y_m;
    if (size == 3) state_[row * size + 2] = observation.pose.heading_rad;
  }
  cost_mm_.assign(count, 0.0);
  const auto horizon = static_cast<std::size_t>(config_.horizon);
  const double fraction = 1.0 / static_cast<double>(particles * horizon);
  for (std::size_t t = 0; t < horizon; ++t) {
    const geometry::Vector2 target_m = observation.target_after_m(t + 1);
    const std::optional<double> heading_rad = observation.target_heading_after_rad(t + 1);
    for (std::size_t c = 0; c < count; ++c)
      cost_mm_[c] += config_.current_cost * candidates_[c][t].squaredNorm();
    for (std::size_t p = 0; p < particles; ++p) {
      const double factor = std::exp(gain.log_mean + gain.log_sigma * quantile_[p]);
      for (std::size_t c = 0; c < count; ++c) {
        const geometry::Drive drive =
            geometry::saturated(factor * task::drive_of(candidates_[c][t], model_->action), limit);
        std::copy(drive.begin(), drive.end(), &drive_[numbers * (p * count + c)]);
      }
      const double* state = &state_[p * count * size];
      const double* drive = &drive_[numbers * p * count];
      double* next = &next_[p * count * size];
      const auto n = static_cast<std::int64_t>(count);
      const inference::FoldedDynamics& member = model_->members[p % members];
      if (model_->sampled) {
        const auto luck = inference::Luck::draw(static_cast<std::int64_t>(size), random_);
        member.sample(state, drive, n, luck, next, workspace_);
      } else {
        member.predict(state, drive, n, next, workspace_);
      }
    }
    for (std::size_t row = 0; row < rows; ++row) {
      double* state = &state_[row * size];
      const double* drive = &drive_[numbers * row];
      const bool driven = std::any_of(drive, drive + numbers, [](double number) { return number != 0.0; });
      if (driven) std::copy_n(&next_[row * size], size, state);
      const geometry::Vector2 position_m(state[0], state[1]);
      double cost_mm = geometry::kMmPerM * std::max(config_.goal_radius_m, (position_m - target_m).norm());
      if (heading_rad && size == 3)
        cost_mm += config_.heading_cost_mm * std::abs(geometry::wrap_angle(state[2] - *heading_rad));
      if (position_m.norm() > model_->dish_radius_m) cost_mm += kOutside_mm;
      cost_mm_[row % count] += fraction * cost_mm;
    }
  }
}

}  // namespace lodestone::control
