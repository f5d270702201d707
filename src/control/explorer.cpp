#include "lodestone/control/explorer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"

namespace lodestone::control {

Explorer::Explorer(const ExplorerConfig& config, const physics::RigDescription& rig,
                   common::RandomStream random)
    : config_(config),
      dish_radius_m_(rig.dish.radius_m),
      drive_(rig),
      random_(std::move(random)),
      freeing_(config.freeing, rig) {
  if (rig.needle.is_sphere()) config_.heading_bins = 1;
  side_ = static_cast<std::int64_t>(std::ceil(2.0 * dish_radius_m_ / config_.cell_m));
  levels_ = 2 * config_.level_bins + 1;
  const auto cells = static_cast<std::size_t>(side_ * side_);
  const auto headings = static_cast<std::size_t>(config_.heading_bins);
  action_levels_ = drive_.size() == 2 ? levels_ * levels_ : drive_.size() * levels_;
  const auto levels = static_cast<std::size_t>(action_levels_);
  at_position_.assign(cells, 0);
  at_pose_.assign(cells * headings, 0);
  level_at_position_.assign(cells * levels, 0);
  level_at_heading_.assign(headings * levels, 0);
  led_to_.assign(cells * levels, -1);
}

void Explorer::reset() {
  acted_ = false;
  last_index_ = -1;
}

double Explorer::mean_visits() const {
  const double cells_in_dish = 0.25 * geometry::kPi * static_cast<double>(side_ * side_);
  return static_cast<double>(visits_) / cells_in_dish;
}

std::int64_t Explorer::cell_of(const geometry::Vector2& position_m) const {
  const auto index = [&](double value_m) {
    const double cell = std::floor((value_m + dish_radius_m_) / config_.cell_m);
    return std::clamp(static_cast<std::int64_t>(cell), std::int64_t{0}, side_ - 1);
  };
  return index(position_m.y()) * side_ + index(position_m.x());
}

std::int64_t Explorer::heading_of(double heading_rad) const {
  const double turns = (geometry::wrap_angle(heading_rad) + geometry::kPi) / (2.0 * geometry::kPi);
  const auto bin = static_cast<std::int64_t>(turns * static_cast<double>(config_.heading_bins));
  return std::clamp(bin, std::int64_t{0}, config_.heading_bins - 1);
}

std::int64_t Explorer::level_of(const geometry::Drive& action) const {
  // The fraction of candidates whose largest number is weaker: each level then holds about as many.
  const auto weaker = [&](double size) {
    const double of_weak = std::max(0.0, 1.0 - std::log(size) / std::log(config_.weakest_drive));
    return (1.0 - config_.weak_fraction) * size + config_.weak_fraction * of_weak;
  };
  const auto bin = [&](double drive) {
    if (drive == 0.0) return config_.level_bins;
    const auto level =
        std::min(static_cast<std::int64_t>(weaker(std::abs(drive)) * static_cast<double>(config_.level_bins)),
                 config_.level_bins - 1);
    return drive > 0.0 ? config_.level_bins + 1 + level : config_.level_bins - 1 - level;
  };
  if (action.size() == 2) return bin(action[1]) * levels_ + bin(action[0]);
  Eigen::Index largest = 0;
  action.cwiseAbs().maxCoeff(&largest);
  return largest * levels_ + bin(action[largest]);
}

geometry::Drive Explorer::draw_action() {
  const auto drive = [&] {
    const double magnitude = random_.uniform(config_.min_drive, 1.0);
    return random_.uniform() < 0.5 ? -magnitude : magnitude;
  };
  geometry::Drive action = geometry::drawn_drive(drive_.size(), drive);
  if (random_.uniform() < config_.single_axis_fraction) {
    const auto one = static_cast<Eigen::Index>(random_.below(static_cast<std::uint64_t>(action.size())));
    for (Eigen::Index i = 0; i < action.size(); ++i)  // of two numbers this one goes, of others it stays
      if ((i == one) == (action.size() == 2)) action[i] = 0.0;
  }
  // Below 0 a coil that takes one sign only is off, which a simulator has to be shown; but not all at once.
  if (strength(action) == 0.0) action = -action;
  if (config_.weak_fraction > 0.0 && random_.uniform() < config_.weak_fraction)
    action *= std::pow(config_.weakest_drive, random_.uniform()) / action.cwiseAbs().maxCoeff();
  return action;
}

double Explorer::strength(const geometry::Drive& action) const {
  double most = 0.0;
  for (Eigen::Index i = 0; i < action.size(); ++i)
    most = std::max(most, drive_.least(static_cast<int>(i)) < 0.0 ? std::abs(action[i]) : action[i]);
  return most;
}

double Explorer::cost(const geometry::Pose2& pose, const geometry::Drive& action) const {
  const auto cell = cell_of(pose.position_m());
  const auto heading = heading_of(pose.heading_rad);
  const auto level = level_of(action);
  const auto count = [](const std::vector<std::int64_t>& counts, std::int64_t index) {
    return std::log1p(static_cast<double>(counts[static_cast<std::size_t>(index)]));
  };
  double cost = count(level_at_position_, cell * action_levels_ + level) +
                count(level_at_heading_, heading * action_levels_ + level);
  if (config_.steering > 0.0) {
    const std::int64_t next = led_to_[static_cast<std::size_t>(cell * action_levels_ + level)];
    // What was never tried here counts as leading to a place visited as often as the mean.
    cost += config_.steering * (next < 0 ? std::log1p(mean_visits()) : count(at_position_, next));
  }
  return cost;
}

/// What the last action did.
void Explorer::see(const geometry::Vector2& position_m) {
  if (acted_ && telling_) {
    const bool moved = (position_m - last_position_m_).norm() >= config_.stuck_threshold_m;
    still_steps_ = moved ? 0 : still_steps_ + 1;
  }
  const auto cell = static_cast<std::size_t>(cell_of(position_m));
  if (last_index_ >= 0) led_to_[static_cast<std::size_t>(last_index_)] = static_cast<std::int64_t>(cell);
  crowded_ = static_cast<double>(at_position_[cell]) > config_.crowding * mean_visits();
  acted_ = true;
  last_position_m_ = position_m;
}

geometry::Drive Explorer::decide(const geometry::Pose2& pose) {
  if (config_.self_reset) {
    if (stuck()) return freeing_.next(pose);
    freeing_.reset();
  }
  geometry::Drive action = geometry::Drive::Zero(drive_.size());
  if (random_.uniform() < config_.zero_fraction) return action;
  double lowest = std::numeric_limits<double>::infinity();
  for (std::int64_t i = 0; i < config_.candidates; ++i) {
    const geometry::Drive candidate = draw_action();
    const double candidate_cost = cost(pose, candidate);
    if (candidate_cost < lowest) {
      lowest = candidate_cost;
      action = candidate;
    }
  }
  return action;
}

void Explorer::keep_count(const geometry::Pose2& pose, const geometry::Drive& action) {
  const auto cell = cell_of(pose.position_m());
  const auto heading = heading_of(pose.heading_rad);
  const auto level = level_of(action);
  last_index_ = cell * action_levels_ + level;
  ++visits_;
  ++at_position_[static_cast<std::size_t>(cell)];
  ++at_pose_[static_cast<std::size_t>(cell * config_.heading_bins + heading)];
  ++level_at_position_[static_cast<std::size_t>(last_index_)];
  ++level_at_heading_[static_cast<std::size_t>(heading * action_levels_ + level)];
}

geometry::Drive Explorer::act(const task::Observation& observation) {
  see(observation.pose.position_m());
  const geometry::Drive action = decide(observation.pose);
  // A needle that a weak pulse did not move is not stuck. An operator does not look so closely.
  telling_ = !config_.self_reset || strength(action) >= config_.min_drive;
  keep_count(observation.pose, action);
  return action;
}

void Explorer::placed() {
  still_steps_ = 0;
  crowded_ = false;
  freeing_.reset();
}

geometry::Pose2 Explorer::next_start(const std::function<bool(const geometry::Pose2&)>& fits) {
  geometry::Pose2 best;
  std::int64_t lowest = std::numeric_limits<std::int64_t>::max();
  for (std::int64_t i = 0; i < config_.candidates; ++i) {
    const double radius_m = config_.start_radius * dish_radius_m_ * std::sqrt(random_.uniform());
    const double angle = random_.uniform(-geometry::kPi, geometry::kPi);
    const geometry::Pose2 pose{radius_m * std::cos(angle), radius_m * std::sin(angle),
                               random_.uniform(-geometry::kPi, geometry::kPi)};
    if (!fits(pose)) continue;
    const auto index = cell_of(pose.position_m()) * config_.heading_bins + heading_of(pose.heading_rad);
    const std::int64_t visits = at_pose_[static_cast<std::size_t>(index)];
    if (visits < lowest) {
      lowest = visits;
      best = pose;
    }
  }
  return best;
}

common::Json Explorer::save() const {
  return {{"random", random_.save()},
          {"at_position", at_position_},
          {"at_pose", at_pose_},
          {"level_at_position", level_at_position_},
          {"level_at_heading", level_at_heading_},
          {"led_to", led_to_},
          {"visits", visits_},
          {"still_steps", still_steps_},
          {"freeing", freeing_.save()}};
}

void Explorer::restore(const common::Json& state) {
  const auto take = [&](const char* key, std::vector<std::int64_t>& counts) {
    auto stored = state.at(key).get<std::vector<std::int64_t>>();
    if (stored.size() != counts.size())
      throw common::DataError(std::string("explorer state: ") + key + " holds " +
                              std::to_string(stored.size()) + " counts, this configuration needs " +
                              std::to_string(counts.size()));
    counts = std::move(stored);
  };
  take("at_position", at_position_);
  take("at_pose", at_pose_);
  take("level_at_position", level_at_position_);
  take("level_at_heading", level_at_heading_);
  take("led_to", led_to_);
  visits_ = state.at("visits").get<std::int64_t>();
  still_steps_ = state.at("still_steps").get<std::int64_t>();
  freeing_.restore(state.at("freeing"));
  random_.restore(state.at("random").get<std::string>());
  reset();
}

}  // namespace lodestone::control
