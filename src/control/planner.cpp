#include "lodestone/control/planner.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "lodestone/common/error.h"
#include "lodestone/common/statistics.h"
#include "lodestone/control/drift_filter.h"
#include "lodestone/control/learned_foresight.h"
#include "lodestone/geometry/pose2.h"
#include "lodestone/geometry/saturation.h"

namespace lodestone::control {
namespace {

/// What lying outside the dish costs beyond the distance: more than any way inside.
constexpr double kOutside_mm = 100.0;
/// The search never narrows down further than this, or it would stop looking.
constexpr double kLeastSpread = 0.02;
/// Where poses are planned for by what was learned: the weakest pulse tried, as a share of the strongest, and
/// how far the second round looks around the best of the first.
constexpr double kWeakest = 0.02;
constexpr double kFirstVariation = 0.4;
/// Headings that are tried where a target has none, evenly around from the needle's own.
constexpr int kHeadings = 24;
/// A needle that is sensed as near as this to where it lay has not moved,
constexpr double kStill_m = 3e-4;
constexpr double kStill_rad = 0.05;
/// and so far around it what lies there counts as lying where it lay.
constexpr double kAround_m = 5e-4;
constexpr double kAround_rad = 0.1;
constexpr std::size_t kMostDearer = 64;
/// Of the tolerance that a cost-to-go was learned with: where that lets a needle rest as near as this to a
/// point, it rests; elsewhere the distance may know better.
constexpr double kNearEnough = 0.5;

/// 0 at the same pose, 1 where the distance or the turn between them is as given.
double square_between(const geometry::Pose2& a, const geometry::Pose2& b, double distance_m,
                      double turn_rad) {
  const double off = (a.position_m() - b.position_m()).norm() / distance_m;
  const double turned = geometry::wrap_angle(a.heading_rad - b.heading_rad) / turn_rad;
  return off * off + turned * turned;
}

bool is_nothing(const std::vector<geometry::Drive>& sequence) {
  return std::all_of(sequence.begin(), sequence.end(),
                     [](const geometry::Drive& action) { return action.isZero(0.0); });
}

/// What lying somewhere costs by the distance to where the target is after so many pulses, and by how the
/// needle shall lie there.
class DistanceCost {
 public:
  DistanceCost(const PlannerConfig& config, const task::Observation& observation, std::size_t pulses,
               bool headings)
      : config_(config), target_m_(observation.target_after_m(pulses)) {
    if (headings) heading_rad_ = observation.target_heading_after_rad(pulses);
    const geometry::Vector2 moves_m = target_m_ - observation.target_after_m(pulses - 1);
    along_path_ = heading_rad_ && moves_m.norm() > 0.0;
    if (along_path_) forwards_ = moves_m.normalized();
  }
  /// Of x, y (m) and, where headings count, heading (rad).
  double mm(const double* state) const {
    geometry::Vector2 off_m = geometry::Vector2(state[0], state[1]) - target_m_;
    const double along_m = off_m.dot(forwards_);
    off_m -= std::clamp(along_m, -config_.along_slack_m, config_.along_slack_m) * forwards_;
    const double off_mm = geometry::kMmPerM * std::max(config_.goal_radius_m, off_m.norm());
    if (!heading_rad_) return off_mm;
    const double turned_mm =
        config_.heading_cost_mm * std::abs(geometry::wrap_angle(state[2] - *heading_rad_));
    return along_path_ ? std::hypot(off_mm, turned_mm) : off_mm + turned_mm;
  }

 private:
  const PlannerConfig& config_;
  geometry::Vector2 target_m_;
  std::optional<double> heading_rad_;
  bool along_path_ = false;
  geometry::Vector2 forwards_ = geometry::Vector2::Zero();
};

}  // namespace

void PlannerConfig::validate() const {
  if (elites > candidates)
    throw common::InvalidConfig("elites", elites, fmt::format("not exceed candidates = {}", candidates));
}

Planner::Planner(std::shared_ptr<Foresight> foresight, const PlannerConfig& config, std::uint64_t seed,
                 std::shared_ptr<const inference::CostToGo> cost_to_go)
    : foresight_(std::move(foresight)),
      config_(config),
      seed_(seed),
      random_(seed, "planner"),
      cost_to_go_(std::move(cost_to_go)) {
  config_.validate();
  const auto particles = std::max(static_cast<std::size_t>(config_.particles), foresight_->facts().ways);
  for (std::size_t k = 0; k < particles; ++k)
    quantile_.push_back(
        common::normal_quantile((static_cast<double>(k) + 0.5) / static_cast<double>(particles)));
  reset();
}

Planner::Planner(std::shared_ptr<const LearnedSimulator> model, const PlannerConfig& config,
                 std::uint64_t seed, std::shared_ptr<const inference::CostToGo> cost_to_go)
    : Planner(std::make_shared<LearnedForesight>(std::move(model)), config, seed, std::move(cost_to_go)) {}

std::unique_ptr<Controller> Planner::clone() const {
  auto other = std::make_unique<Planner>(*this);
  other->foresight_ = foresight_->clone();
  return other;
}

void Planner::reset() {
  random_ = common::RandomStream(seed_, "planner");
  plan_.assign(static_cast<std::size_t>(config_.horizon),
               geometry::Drive::Zero(foresight_->facts().action.size));
  pose_before_.reset();
  dearer_.clear();
  led_no_further_ = false;
}

std::vector<std::size_t> Planner::best(std::size_t count) const {
  std::vector<std::size_t> order(candidates_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  count = std::min(count, order.size());
  std::partial_sort(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
      [this](std::size_t a, std::size_t b) { return cost_[a] != cost_[b] ? cost_[a] < cost_[b] : a < b; });
  order.resize(count);
  return order;
}

geometry::Pose2 Planner::cheapest_goal(const task::Observation& observation) {
  const geometry::Pose2& pose = observation.pose;
  geometry::Pose2 goal{observation.target_m.x(), observation.target_m.y(), 0.0};
  if (observation.target_heading_rad) {
    goal.heading_rad = *observation.target_heading_rad;
    return goal;
  }
  std::vector<geometry::Pose2> goals(kHeadings, goal);
  std::vector<double> state, cost(kHeadings);
  for (int k = 0; k < kHeadings; ++k) {
    goals[static_cast<std::size_t>(k)].heading_rad =
        geometry::wrap_angle(pose.heading_rad + 2.0 * geometry::kPi * k / kHeadings);
    state.insert(state.end(), {pose.x_m, pose.y_m, pose.heading_rad});
  }
  cost_to_go_->evaluate(state.data(), goals.data(), 1, kHeadings, cost.data(), judge_);
  return goals[static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin())];
}

void Planner::look_around(const Sequence& mean, const Sequence& spread) {
  candidates_.push_back(mean);
  while (candidates_.size() < static_cast<std::size_t>(config_.candidates)) {
    Sequence& candidate = candidates_.emplace_back(mean);
    for (std::size_t t = 0; t < candidate.size(); ++t) {
      const geometry::Drive noise =
          geometry::drawn_drive(foresight_->facts().action.size, [this] { return random_.normal(); });
      candidate[t] = geometry::saturated(candidate[t] + spread[t].cwiseProduct(noise));
    }
  }
}

void Planner::look_around(const std::vector<Sequence>& elites, std::int64_t round) {
  const double share = kFirstVariation * std::pow(0.5, static_cast<double>(round - 1));
  candidates_.insert(candidates_.end(), elites.begin(), elites.end());
  for (std::size_t next = 0; candidates_.size() < static_cast<std::size_t>(config_.candidates); ++next) {
    Sequence& candidate = candidates_.emplace_back(
        elites.empty() ? Sequence(static_cast<std::size_t>(config_.horizon)) : elites[next % elites.size()]);
    for (geometry::Drive& action : candidate)
      action = elites.empty() ? task::draw_action(foresight_->facts().action.size, kWeakest, random_)
                              : task::vary_action(action, share, random_);
  }
}

void Planner::note_stillness(const task::Observation& observation) {
  const geometry::Pose2& pose = observation.pose;
  if ((observation.target_m - target_before_m_).norm() > kStill_m ||
      observation.target_heading_rad != target_heading_before_rad_) {
    dearer_.clear();  // elsewhere, other places are on the way
    led_no_further_ = false;
  }
  const bool still = pose_before_ && square_between(pose, *pose_before_, kStill_m, kStill_rad) < 1.0;
  if (still && by_cost_to_go_ && !plan_.front().isZero(0.0)) {
    const auto near = std::find_if(dearer_.begin(), dearer_.end(), [&pose](const Dearer& each) {
      return square_between(pose, each.pose, kStill_m, kStill_rad) < 1.0;
    });
    if (near != dearer_.end())
      near->cost += 1.0;
    else
      dearer_.push_back({pose, 1.0});
    if (dearer_.size() > kMostDearer) dearer_.erase(dearer_.begin());
  }
  pose_before_ = pose;
  target_before_m_ = observation.target_m;
  target_heading_before_rad_ = observation.target_heading_rad;
}

geometry::Drive Planner::act(const task::Observation& observation) {
  const bool costs = cost_to_go_ && observation.ahead.empty() && foresight_->facts().state_size == 3;
  if (costs) {
    note_stillness(observation);
    goal_ = cheapest_goal(observation);
  }
  // What was the second pulse is the first one now, and one proposal among others.
  std::rotate(plan_.begin(), plan_.begin() + 1, plan_.end());
  plan_.back().setZero();
  const bool headed = observation.target_heading_rad.has_value();
  by_cost_to_go_ = costs && (headed || led_no_further_);
  plan_ = searched(observation);
  const auto near_enough = [&] {
    return by_cost_to_go_ && (observation.pose.position_m() - observation.target_m).norm() <
                                 kNearEnough * cost_to_go_->cost().tolerance_m;
  };
  if (costs && !headed && is_nothing(plan_) && !near_enough()) {  // the other one may know better
    led_no_further_ = true;
    by_cost_to_go_ = !by_cost_to_go_;
    plan_ = searched(observation);
  }
  if (!costs && observation.ahead.empty() && is_nothing(plan_)) {  // a pulse that fails can be tried again
    const double now[3] = {observation.pose.x_m, observation.pose.y_m, observation.pose.heading_rad};
    most_mm_ = DistanceCost(config_, observation, 1, foresight_->facts().state_size == 3).mm(now);
    plan_ = searched(observation);
    most_mm_ = std::numeric_limits<double>::infinity();
  }
  return plan_.front();
}

Planner::Sequence Planner::searched(const task::Observation& observation) {
  const auto horizon = static_cast<std::size_t>(config_.horizon);
  const int numbers = foresight_->facts().action.size;
  const Sequence nothing(horizon, geometry::Drive::Zero(numbers));
  Sequence mean = nothing;
  Sequence spread(horizon, geometry::Drive::Constant(numbers, config_.spread));
  std::vector<Sequence> elites;
  for (std::int64_t iteration = 0; iteration < config_.iterations; ++iteration) {
    candidates_ = {nothing, plan_};
    if (by_cost_to_go_)
      look_around(elites, iteration);
    else
      look_around(mean, spread);
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
  if (!by_cost_to_go_) candidates_.push_back(mean);
  candidates_.push_back(nothing);
  evaluate_candidates(observation);
  return candidates_[best(1).front()];
}

void Planner::add_distances(const task::Observation& observation, std::size_t t, double fraction) {
  const std::size_t count = candidates_.size();
  const std::size_t size = foresight_->facts().state_size;
  const DistanceCost distance(config_, observation, t + 1, size == 3);
  for (std::size_t row = 0; row < state_.size() / size; ++row) {
    const double* state = &state_[row * size];
    double cost_mm = std::min(most_mm_, distance.mm(state));
    if (std::hypot(state[0], state[1]) > foresight_->facts().dish_radius_m) cost_mm += kOutside_mm;
    cost_[row % count] += fraction * cost_mm;
  }
}

void Planner::add_pose_costs(std::size_t t, double fraction) {
  const std::size_t rows = state_.size() / 3;
  row_cost_.resize(rows);
  if (t + 1 == static_cast<std::size_t>(config_.horizon)) {
    const auto n = static_cast<std::int64_t>(rows);
    cost_to_go_->evaluate(state_.data(), &goal_, n, n, row_cost_.data(), judge_);
    for (std::size_t row = 0; row < rows; ++row) {
      const geometry::Pose2 pose{state_[3 * row], state_[3 * row + 1], state_[3 * row + 2]};
      for (const Dearer& each : dearer_)
        row_cost_[row] += each.cost * std::exp(-square_between(pose, each.pose, kAround_m, kAround_rad));
    }
  } else {
    for (std::size_t row = 0; row < rows; ++row)
      row_cost_[row] =
          cost_to_go_->cost().at({state_[3 * row], state_[3 * row + 1], state_[3 * row + 2]}, goal_);
  }
  for (std::size_t row = 0; row < rows; ++row) cost_[row % candidates_.size()] += fraction * row_cost_[row];
}

void Planner::move(const task::Observation& observation, std::size_t t, const double* next,
                   double* state) const {
  const std::size_t size = foresight_->facts().state_size;
  if (!observation.drift_m.empty() && size == 3) {
    const geometry::Pose2 from{state[0], state[1], state[2]}, to{next[0], next[1], next[2]};
    if (square_between(from, to, kStill_m, kStill_rad) >= 1.0) {
      const geometry::Vector2& across_m = observation.drift_m[std::min(t, observation.drift_m.size() - 1)];
      const geometry::Vector2 by_m = carried_m(across_m, from, to);
      state[0] = next[0] + by_m.x();
      state[1] = next[1] + by_m.y();
      state[2] = next[2];
      return;
    }
  }
  std::copy_n(next, size, state);
}

void Planner::evaluate_candidates(const task::Observation& observation) {
  const std::size_t count = candidates_.size();
  const Foresight::Facts& facts = foresight_->facts();
  const bool alike = !observation.drive_gain && !facts.by_chance;
  const std::size_t particles = alike ? facts.ways : quantile_.size();
  const task::DriveGain gain = observation.drive_gain.value_or(task::DriveGain{});
  const double limit = facts.action.scale;
  const std::size_t size = facts.state_size;
  const std::size_t rows = count * particles;
  state_.resize(rows * size);
  next_.resize(rows * size);
  const auto numbers = static_cast<std::size_t>(facts.action.size);
  drive_.resize(numbers * rows);
  for (std::size_t row = 0; row < rows; ++row) {
    state_[row * size] = observation.pose.x_m;
    state_[row * size + 1] = observation.pose.y_m;
    if (size == 3) state_[row * size + 2] = observation.pose.heading_rad;
  }
  cost_.assign(count, 0.0);
  const auto horizon = static_cast<std::size_t>(config_.horizon);
  const bool learned = by_cost_to_go_;
  const double fraction = 1.0 / static_cast<double>(learned ? particles : particles * horizon);
  for (std::size_t t = 0; t < horizon; ++t) {
    const double later = learned ? std::pow(cost_to_go_->cost().discount, static_cast<double>(t)) : 1.0;
    const double current_cost = learned ? later * cost_to_go_->cost().current_cost : config_.current_cost;
    for (std::size_t c = 0; c < count; ++c) cost_[c] += current_cost * candidates_[c][t].squaredNorm();
    for (std::size_t p = 0; p < particles; ++p) {
      const double factor = std::exp(gain.log_mean + gain.log_sigma * quantile_[p]);
      for (std::size_t c = 0; c < count; ++c) {
        const geometry::Drive drive =
            geometry::saturated(factor * task::drive_of(candidates_[c][t], facts.action), limit);
        std::copy(drive.begin(), drive.end(), &drive_[numbers * (p * count + c)]);
      }
      foresight_->foresee(p % facts.ways, t, &state_[p * count * size], &drive_[numbers * p * count],
                          static_cast<std::int64_t>(count), random_, &next_[p * count * size]);
    }
    for (std::size_t row = 0; row < rows; ++row) {
      double* state = &state_[row * size];
      const double* drive = &drive_[numbers * row];
      const bool driven = std::any_of(drive, drive + numbers, [](double number) { return number != 0.0; });
      if (driven) move(observation, t, &next_[row * size], state);
    }
    if (learned)
      add_pose_costs(t, later * fraction);
    else
      add_distances(observation, t, fraction);
  }
  if (!learned) return;
  const inference::PoseCost& cost = cost_to_go_->cost();
  for (std::size_t c = 0; c < count; ++c) {
    if (is_nothing(candidates_[c]))
      cost_[c] = observation.awaited ? cost.most() : cost.of_staying(observation.pose, goal_);
  }
}

}  // namespace lodestone::control
