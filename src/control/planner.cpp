#include "lodestone/control/planner.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lodestone/common/error.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::control {
namespace {

/// What lying outside the dish costs beyond the distance: more than any way inside.
constexpr double kOutside_mm = 100.0;
/// The target when pulse `t` of the plan is over.
geometry::Vector2 target_after_m(const task::Observation& observation, std::size_t t) {
  if (observation.ahead.empty()) return observation.target_m;
  return observation.ahead[std::min(t, observation.ahead.size() - 1)].point_m;
}
/// The search never narrows down further than this, or it would stop looking.
constexpr double kLeastSpread = 0.02;

}  // namespace

void PlannerConfig::validate() const {
  if (elites > candidates)
    throw common::InvalidConfig("elites", elites, fmt::format("not exceed candidates = {}", candidates));
}

PlannerModel::PlannerModel(const inference::DynamicsModel& model)
    : members(model.members),
      state_size(static_cast<std::size_t>(data::state_size(model.info.layout))),
      sampled(model.config.components > 0),
      dish_radius_m(model.info.workspace_radius_m) {
  LODESTONE_CHECK(!members.empty(), "the ensemble has no member");
  action.scale = model.info.action_scale;
  action.one_axis_at_a_time = model.info.one_axis_at_a_time;
}

Planner::Planner(std::shared_ptr<const PlannerModel> model, const PlannerConfig& config, std::uint64_t seed)
    : model_(std::move(model)), config_(config), seed_(seed), random_(seed, "planner") {
  config_.validate();
  const auto rows = static_cast<std::size_t>(config_.candidates) * model_->members.size();
  state_.resize(rows * model_->state_size);
  next_.resize(state_.size());
  drive_.resize(2 * rows);
  streams_.assign(static_cast<std::size_t>(config_.candidates), &random_);
  reset();
}

void Planner::reset() {
  random_ = common::RandomStream(seed_, "planner");
  plan_.assign(static_cast<std::size_t>(config_.horizon), geometry::Vector2::Zero());
}

geometry::Vector2 Planner::act(const task::Observation& observation) {
  // What was the second pulse is the first one now.
  std::rotate(plan_.begin(), plan_.begin() + 1, plan_.end());
  plan_.back().setZero();
  const auto horizon = plan_.size();
  const auto count = static_cast<std::size_t>(config_.candidates);
  const auto elites = static_cast<std::size_t>(config_.elites);
  std::vector<geometry::Vector2> spread(horizon, geometry::Vector2::Constant(config_.spread));
  std::vector<std::size_t> order(count);
  for (std::int64_t iteration = 0; iteration < config_.iterations; ++iteration) {
    candidates_.resize(count * horizon);
    for (std::size_t c = 0; c < count; ++c) {
      for (std::size_t t = 0; t < horizon; ++t) {
        const geometry::Vector2 noise(random_.normal(), random_.normal());
        // The last but one candidate is the plan itself, the last one does nothing at all.
        geometry::Vector2 action = plan_[t];
        if (c + 2 < count) action += spread[t].cwiseProduct(noise);
        if (c + 1 == count) action.setZero();
        candidates_[c * horizon + t] = geometry::saturated(action);
      }
    }
    evaluate_candidates(observation);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(elites), order.end(),
                      [this](std::size_t a, std::size_t b) {
                        return cost_mm_[a] != cost_mm_[b] ? cost_mm_[a] < cost_mm_[b] : a < b;
                      });
    if (order.front() + 1 == count) return geometry::Vector2::Zero();  // nothing beats lying still
    for (std::size_t t = 0; t < horizon; ++t) {
      geometry::Vector2 mean = geometry::Vector2::Zero();
      geometry::Vector2 square = geometry::Vector2::Zero();
      for (std::size_t e = 0; e < elites; ++e) {
        const geometry::Vector2& action = candidates_[order[e] * horizon + t];
        mean += action;
        square += action.cwiseProduct(action);
      }
      mean /= static_cast<double>(elites);
      square /= static_cast<double>(elites);
      plan_[t] = mean;
      spread[t] = (square - mean.cwiseProduct(mean)).cwiseMax(kLeastSpread * kLeastSpread).cwiseSqrt();
    }
  }
  return plan_.front();
}

void Planner::evaluate_candidates(const task::Observation& observation) {
  const auto count = static_cast<std::size_t>(config_.candidates);
  const std::size_t members = model_->members.size();
  const std::size_t size = model_->state_size;
  const std::size_t rows = count * members;
  for (std::size_t row = 0; row < rows; ++row) {
    state_[row * size] = observation.pose.x_m;
    state_[row * size + 1] = observation.pose.y_m;
    if (size == 3) state_[row * size + 2] = observation.pose.heading_rad;
  }
  cost_mm_.assign(count, 0.0);
  const auto horizon = static_cast<std::size_t>(config_.horizon);
  const double fraction = 1.0 / static_cast<double>(members * horizon);
  for (std::size_t t = 0; t < horizon; ++t) {
    const geometry::Vector2 target_m = target_after_m(observation, t);
    for (std::size_t row = 0; row < rows; ++row) {
      const geometry::Vector2& action = candidates_[(row % count) * horizon + t];
      const geometry::Vector2 drive = task::axis_drive(action, model_->action);
      drive_[2 * row] = drive.x();
      drive_[2 * row + 1] = drive.y();
      cost_mm_[row % count] += config_.current_cost * action.squaredNorm() / static_cast<double>(members);
    }
    for (std::size_t m = 0; m < members; ++m) {
      const double* state = &state_[m * count * size];
      const double* drive = &drive_[2 * m * count];
      double* next = &next_[m * count * size];
      const auto n = static_cast<std::int64_t>(count);
      if (model_->sampled) {
        model_->members[m].sample(state, drive, n, streams_.data(), next, workspace_);
      } else {
        model_->members[m].predict(state, drive, n, next, workspace_);
      }
    }
    for (std::size_t row = 0; row < rows; ++row) {
      double* state = &state_[row * size];
      if (drive_[2 * row] != 0.0 || drive_[2 * row + 1] != 0.0) std::copy_n(&next_[row * size], size, state);
      const geometry::Vector2 position_m(state[0], state[1]);
      double cost_mm = geometry::kMmPerM * std::max(config_.goal_radius_m, (position_m - target_m).norm());
      if (observation.target_heading_rad && size == 3)
        cost_mm += config_.heading_cost_mm *
                   std::abs(geometry::wrap_angle(state[2] - *observation.target_heading_rad));
      if (position_m.norm() > model_->dish_radius_m) cost_mm += kOutside_mm;
      cost_mm_[row % count] += fraction * cost_mm;
    }
  }
}

}  // namespace lodestone::control
