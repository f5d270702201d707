#include "lodestone/rl/value_iteration_learner.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

#include <ATen/core/grad_mode.h>
#include <ATen/ops/zeros_like.h>

#include "lodestone/common/error.h"
#include "lodestone/env/mbs_env.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/geometry/saturation.h"
#include "lodestone/nets/optimiser.h"
#include "lodestone/rl/policy_evaluation.h"
#include "lodestone/rl/proposals.h"
#include "lodestone/rl/training_checkpoint.h"
#include "lodestone/runs/curves.h"

namespace lodestone::rl {
namespace {

/// Fixed, so that results do not depend on the number of threads.
constexpr std::int64_t kRowsOfShard = 64;
constexpr double kPoseToo = 0.2;             // of the new goals, the share that comes with a new pose
constexpr double kNearestGoal_deg = 1.0;     // and so little turned
constexpr double kMostTurnOnPath_rad = 0.1;  // a pulse
constexpr double kAnyPulse = 0.05;           // share of the pulses that are any, whatever was decided
constexpr float kFirstOdds = -2.0F;          // logarithm of the proposals' strength
constexpr double kRefined[] = {0.3, 0.1};    // how far refinements lie from the best pulse, round by round

geometry::Pose2 noisy(const geometry::Pose2& pose, double noise_m, double noise_rad,
                      common::RandomStream& random) {
  return {pose.x_m + noise_m * random.normal(), pose.y_m + noise_m * random.normal(),
          geometry::wrap_angle(pose.heading_rad + noise_rad * random.normal())};
}

/// The numbers of a needle in the order checkpoints hold them.
template <class Needle, class Visit>
void visit_needle(Needle& needle, Visit&& visit) {
  for (double* value :
       {&needle.pose.x_m, &needle.pose.y_m, &needle.pose.heading_rad, &needle.goal.x_m, &needle.goal.y_m,
        &needle.goal.heading_rad, &needle.goal_step_m.x(), &needle.goal_step_m.y(), &needle.goal_turn_rad,
        &needle.told.log_mean, &needle.told.log_sigma, &needle.log_gain, &needle.log_place,
        &needle.place_m.x(), &needle.place_m.y()})
    visit(*value);
  for (double& number : needle.last_action) visit(number);
  for (double& number : needle.last_displacement_m) visit(number);
}

/// And of a decision.
template <class Decision, class Visit>
void visit_decision(Decision& decision, Visit&& visit) {
  const auto as_double = [&visit](auto& number) {
    double value = static_cast<double>(number);
    visit(value);
    number = static_cast<std::remove_reference_t<decltype(number)>>(value);
  };
  for (float& number : decision.observation) as_double(number);
  for (float& number : decision.features) as_double(number);
  as_double(decision.still);
  visit(decision.cost);
  for (double& number : decision.action) visit(number);
}

/// What a pulse may come to: the same for every pulse that is held against another.
struct Outcome {
  inference::Luck luck;
  double gain_off;  // of the estimate, in its standard deviations
};

std::vector<Outcome> draw_outcomes(std::int64_t count, common::RandomStream& random) {
  std::vector<Outcome> outcomes;
  for (std::int64_t k = 0; k < count; ++k) {
    const inference::Luck luck = inference::Luck::draw(3, random);
    outcomes.push_back({luck, random.normal()});
  }
  return outcomes;
}

}  // namespace

/// Buffers to try pulses in.
struct ValueIterationLearner::Tries {
  std::vector<geometry::Drive> action;  // [needles, count]
  std::vector<double> cost;             // likewise, mean over the outcomes
  std::size_t count = 0;
};

ValueIterationLearner::Shard::Shard(std::uint64_t seed, std::size_t index, std::int64_t rows)
    : random(seed, "value iteration", index), needles(static_cast<std::size_t>(rows)) {}

ValueIterationLearner::ValueIterationLearner(const LearningConfig& learning,
                                             const ValueIterationConfig& config, const ImaginedTask& task,
                                             inference::DynamicsModel model, std::uint64_t seed,
                                             std::int64_t threads)
    : learning_(learning),
      config_(config),
      task_(task),
      encoder_(task.encoder),
      model_(std::move(model)),
      starts_(env::starts_within(model_, task.task.start_radius_m(), task.region.get())),
      actor_(layer_widths(encoder_.size(), config.hidden,
                          inference::Actor::outputs(task.action.size, config.proposals))),
      value_(layer_widths(inference::CostToGo::kFeatures, config.value_hidden, 1)),
      target_(layer_widths(inference::CostToGo::kFeatures, config.value_hidden, 1)),
      pool_(static_cast<std::size_t>(threads)) {
  if (model_.config.components == 0)
    throw common::ConfigError(
        "method = \"value_iteration\", but the dynamics predict single values; train them with "
        "model.components of 1 or more");
  if (data::state_size(model_.info.layout) != 3 || task.task.goal != task::GoalKind::kPose ||
      !task.encoder.target_heading)
    throw common::ConfigError(
        "method = \"value_iteration\" is for poses: it needs dynamics that know the heading, task.goal = "
        "pose, and encoder.target_heading = true");
  config_.cost.dish_radius_m = task.task.dish_radius_m;
  common::RandomStream random(seed, "actor", 0);
  actor_.initialise(random);
  set_proposals_apart(actor_, config.hidden.size(), task.action.size, config.proposals, kFirstOdds);
  common::RandomStream value_random(seed, "value", 0);
  value_.initialise(value_random);
  target_ = value_.clone();
  for (int k = 0; k < 2; ++k) {
    actor_moments_[k] = at::zeros_like(actor_.parameters());
    value_moments_[k] = at::zeros_like(value_.parameters());
  }
  for (std::int64_t first = 0; first < task.environments; first += kRowsOfShard) {
    const std::int64_t rows = std::min(kRowsOfShard, task.environments - first);
    Shard& shard = shards_.emplace_back(seed, shards_.size(), rows);
    shard.actor = actor_.workspace(rows);
    shard.value = value_.workspace(rows);
    const auto count = static_cast<std::size_t>(rows);
    shard.observation.resize(count * static_cast<std::size_t>(encoder_.size()));
    shard.features.resize(count * static_cast<std::size_t>(inference::CostToGo::kFeatures));
    shard.actor_gradient.resize(static_cast<std::size_t>(shard.actor.output.numel()));
    shard.value_gradient.resize(count);
    shard.seen.resize(count);
    shard.goal_after.resize(count);
    shard.given.resize(count);
    for (Needle& needle : shard.needles) {
      needle.last_action = geometry::Drive::Zero(task.action.size);
      draw_pose(needle, shard.random);
      draw_goal(needle, shard.random);
    }
  }
  renew_judge();
}

void ValueIterationLearner::renew_judge() {
  judge_.emplace(arrays_of(target_), config_.value_hidden, config_.cost);
}

double ValueIterationLearner::progress() const {
  return std::min(1.0, static_cast<double>(env_steps_) / static_cast<double>(learning_.env_steps));
}

void ValueIterationLearner::draw_pose(Needle& needle, common::RandomStream& random) const {
  needle.put(starts_[random.below(starts_.size())], config_, random);
}

void ValueIterationLearner::draw_goal(Needle& needle, common::RandomStream& random) const {
  const task::TaskConfig& task = task_.task;
  const task::Goal goal = task::draw_goal(task, random, task_.region.get());
  geometry::Vector2 at_m = goal.position_m;
  double heading_rad = *goal.heading_rad;
  if (random.uniform() < config_.near_goals) {
    if (const auto near_m = draw_near_m(needle.pose.position_m(), task_, random)) at_m = *near_m;
    const double turn_deg = draw_log_uniform(kNearestGoal_deg, 180.0, random);
    heading_rad =
        needle.pose.heading_rad + (random.uniform() < 0.5 ? 1.0 : -1.0) * geometry::kRadPerDeg * turn_deg;
  }
  needle.goal_step_m.setZero();
  needle.goal_turn_rad = 0.0;
  if (random.uniform() < config_.moving_goals) {
    const double step_m = config_.most_target_step_m * random.uniform();
    needle.goal_step_m = step_m * geometry::Vector2(std::cos(heading_rad), std::sin(heading_rad));
    needle.goal_turn_rad = kMostTurnOnPath_rad * random.uniform(-1.0, 1.0);
  }
  needle.goal = {at_m.x(), at_m.y(), geometry::wrap_angle(heading_rad)};
  needle.draw_rig(config_, random);
}

geometry::Pose2 ValueIterationLearner::goal_after(const Needle& needle) const {
  return {needle.goal.x_m + needle.goal_step_m.x(), needle.goal.y_m + needle.goal_step_m.y(),
          geometry::wrap_angle(needle.goal.heading_rad + needle.goal_turn_rad)};
}

void ValueIterationLearner::step() {
  const at::NoGradGuard no_grad;
  pool_.for_each(shards_.size(), [this](std::size_t index) { decide(shards_[index], index); });
  ++decisions_;
  const double rate = config_.learning_rate * (1.0 - (1.0 - learning_.final_learning_rate) * progress());
  for (std::int64_t update = 0; update < config_.updates; ++update) {
    pool_.for_each(shards_.size(), [this](std::size_t index) { learn(shards_[index]); });
    ++updates_;
    descend(actor_, actor_moments_, rate, [](const Shard& shard) { return shard.actor.gradient; });
    descend(value_, value_moments_, rate, [](const Shard& shard) { return shard.value.gradient; });
    for (const Shard& shard : shards_) {
      value_loss_sum_ += shard.value_loss;
      actor_loss_sum_ += shard.actor_loss;
      saturated_sum_ += shard.saturated;
    }
    updates_summed_ += 1.0;
  }
  if (!std::isfinite(value_loss_sum_ + actor_loss_sum_))
    throw common::Error("training the policy diverged at environment step " + std::to_string(env_steps_) +
                        " (its loss is not finite); lower value_iteration.learning_rate");
  nets::polyak_step(target_.parameters().data_ptr<float>(), value_.parameters().data_ptr<float>(),
                    static_cast<std::size_t>(value_.parameters().numel()), config_.polyak);
  renew_judge();
  env_steps_ += task_.environments;
}

template <class GradientOf>
void ValueIterationLearner::descend(FlatNetwork<float>& network, at::Tensor (&moments)[2], double rate,
                                    const GradientOf& gradient_of) const {
  at::Tensor gradient = at::zeros_like(network.parameters());
  for (const Shard& shard : shards_) gradient.add_(gradient_of(shard));
  nets::adam_step(network.parameters().data_ptr<float>(), gradient.data_ptr<float>(),
                  moments[0].data_ptr<float>(), moments[1].data_ptr<float>(),
                  static_cast<std::size_t>(gradient.numel()), rate, updates_);
}

void ValueIterationLearner::observe(Shard& shard) const {
  const auto columns = static_cast<std::size_t>(encoder_.size());
  task::Observation observation;
  for (std::size_t i = 0; i < shard.needles.size(); ++i) {
    const Needle& needle = shard.needles[i];
    shard.seen[i] = noisy(needle.pose, task_.pose_noise_m, task_.heading_noise_rad, shard.random);
    shard.goal_after[i] = goal_after(needle);
    observation.pose = shard.seen[i];
    observation.target_m = needle.goal.position_m();
    observation.target_heading_rad = shard.goal_after[i].heading_rad;
    observation.ahead = {{shard.goal_after[i].position_m(), 1.0, shard.goal_after[i].heading_rad}};
    observation.drive_gain = needle.told;
    observation.last_action = needle.last_action;
    observation.last_displacement_m = needle.last_displacement_m;
    encoder_.encode(observation, &shard.observation[i * columns]);
  }
}

void ValueIterationLearner::judge(Shard& shard, Tries& tries, std::int64_t particles,
                                  std::size_t turn) const {
  common::RandomStream& random = shard.random;
  const std::size_t rows = tries.action.size();
  shard.state.resize(3 * rows);
  shard.next.resize(3 * rows);
  const auto numbers = static_cast<std::size_t>(task_.action.size);
  shard.drive.resize(numbers * rows);
  shard.cost.resize(rows);
  tries.cost.assign(rows, 0.0);
  for (std::size_t row = 0; row < rows; ++row) {
    const geometry::Pose2& seen = shard.seen[row / tries.count];
    const double state[] = {seen.x_m, seen.y_m, seen.heading_rad};
    std::copy_n(state, 3, &shard.state[3 * row]);
  }
  std::size_t member = turn;
  for (const Outcome& outcome : draw_outcomes(particles, random)) {
    for (std::size_t row = 0; row < rows; ++row) {
      const task::DriveGain& told = shard.needles[row / tries.count].told;
      const double factor = std::exp(told.log_mean + told.log_sigma * outcome.gain_off);
      const geometry::Drive drive =
          geometry::saturated(factor * task::drive_of(tries.action[row], task_.action), task_.action.scale);
      std::copy_n(drive.data(), numbers, &shard.drive[numbers * row]);
    }
    const auto n = static_cast<std::int64_t>(rows);
    model_.members[member++ % model_.members.size()].sample(shard.state.data(), shard.drive.data(), n,
                                                            outcome.luck, shard.next.data(), shard.dynamics);
    for (std::size_t row = 0; row < rows; ++row)
      if (tries.action[row].isZero(0.0)) std::copy_n(&shard.state[3 * row], 3, &shard.next[3 * row]);
    judge_->evaluate(shard.next.data(), shard.goal_after.data(), static_cast<std::int64_t>(tries.count), n,
                     shard.cost.data(), shard.judge);
    for (std::size_t row = 0; row < rows; ++row)
      tries.cost[row] += shard.cost[row] / static_cast<double>(particles);
  }
  for (std::size_t row = 0; row < rows; ++row)
    tries.cost[row] += config_.cost.current_cost * tries.action[row].squaredNorm();
}

void ValueIterationLearner::decide(Shard& shard, std::size_t turn) const {
  observe(shard);
  const std::size_t needles = shard.needles.size();
  const auto best_of = [](const Tries& tries, std::size_t needle) {
    const auto first = tries.cost.begin() + static_cast<std::ptrdiff_t>(needle * tries.count);
    return needle * tries.count +
           static_cast<std::size_t>(
               std::min_element(first, first + static_cast<std::ptrdiff_t>(tries.count)) - first);
  };
  turn += static_cast<std::size_t>(decisions_);
  // Any pulses, and what the policy would do: so each gets better by the other.
  const int size = task_.action.size;
  Tries tries;
  const auto led_by_policy =
      static_cast<std::size_t>(std::lround(config_.policy_share * static_cast<double>(needles)));
  actor_.forward(shard.observation.data(), shard.actor);
  const float* output = shard.actor.output.data_ptr<float>();
  const std::size_t outputs = shard.actor_gradient.size() / needles;
  tries.count = static_cast<std::size_t>(config_.candidates + config_.proposals);
  for (std::size_t i = 0; i < needles; ++i) {
    for (std::int64_t k = 0; k < config_.proposals; ++k) {
      float action[geometry::kMostDrives];
      inference::Actor::propose(output + i * outputs, size, k, action);
      tries.action.push_back(geometry::as_drive(action, size));
    }
    const std::int64_t chosen = inference::Actor::choose(output + i * outputs, size, config_.proposals);
    shard.given[i] = chosen == config_.proposals
                         ? geometry::Drive(geometry::Drive::Zero(size))
                         : tries.action[i * tries.count + static_cast<std::size_t>(chosen)];
    while (tries.action.size() < (i + 1) * tries.count)
      tries.action.push_back(task::draw_action(size, config_.weakest, shard.random));
  }
  judge(shard, tries, config_.particles, turn);
  for (const double share : kRefined) {
    Tries near;
    near.count = static_cast<std::size_t>(config_.refinements) + 1;
    for (std::size_t i = 0; i < needles; ++i) {
      const geometry::Drive& best = tries.action[best_of(tries, i)];
      near.action.push_back(best);
      while (near.action.size() < (i + 1) * near.count)
        near.action.push_back(task::vary_action(best, share, shard.random));
    }
    judge(shard, near, config_.particles, ++turn);
    tries = std::move(near);
  }
  Tries last;
  // By outcomes that it was not chosen by, beside resting.
  last.count = 2;
  for (std::size_t i = 0; i < needles; ++i) {
    last.action.push_back(tries.action[best_of(tries, i)]);
    last.action.push_back(geometry::Drive::Zero(size));
  }
  judge(shard, last, 2 * config_.particles, ++turn);
  for (std::size_t i = 0; i < needles; ++i)
    if (shard.needles[i].still())
      last.cost[2 * i + 1] = config_.cost.of_staying(shard.seen[i], shard.needles[i].goal);
  const auto columns = static_cast<std::size_t>(encoder_.size());
  const std::size_t slot = static_cast<std::size_t>(decisions_ % config_.replayed) * needles;
  if (shard.decisions.size() < slot + needles) shard.decisions.resize(slot + needles);
  for (std::size_t i = 0; i < needles; ++i) {
    const std::size_t best = best_of(last, i);
    Decision& decision = shard.decisions[slot + i];
    const float* observed = &shard.observation[i * columns];
    decision.observation.assign(observed, observed + columns);
    inference::CostToGo::write_features(shard.seen[i], shard.goal_after[i], config_.cost.dish_radius_m,
                                        decision.features);
    decision.cost = std::clamp(last.cost[best] / config_.cost.most(), 0.0, 1.0);
    decision.still = shard.needles[i].still();
    decision.action = last.action[best];
    if (i >= led_by_policy) shard.given[i] = decision.action;
    if (decision.still && config_.cost.within(config_.rest_within, shard.seen[i], shard.needles[i].goal))
      decision.action.setZero();
  }
  give_pulses(shard, turn);
}

void ValueIterationLearner::give_pulses(Shard& shard, std::size_t turn) const {
  common::RandomStream& random = shard.random;
  const double scale = task_.action.scale;
  const inference::FoldedDynamics& member = model_.members[turn % model_.members.size()];
  for (std::size_t i = 0; i < shard.needles.size(); ++i) {
    Needle& needle = shard.needles[i];
    geometry::Drive action = shard.given[i];
    if (random.uniform() < kAnyPulse) action = task::draw_action(task_.action.size, config_.weakest, random);
    const geometry::Vector2 before_m = needle.pose.position_m();
    if (!action.isZero(0.0)) {
      const geometry::Drive drive =
          geometry::saturated(needle.factor() * task::drive_of(action, task_.action), scale);
      double state[3] = {needle.pose.x_m, needle.pose.y_m, needle.pose.heading_rad};
      const inference::Luck luck = inference::Luck::draw(3, random);
      member.sample(state, drive.data(), 1, luck, state, shard.dynamics);
      needle.pose = {state[0], state[1], state[2]};
    }
    needle.note_pulse(action, before_m, config_, random);
    needle.goal = shard.goal_after[i];
    const geometry::Vector2 step_m = needle.goal_step_m;
    const double c = std::cos(needle.goal_turn_rad), s = std::sin(needle.goal_turn_rad);
    needle.goal_step_m = {c * step_m.x() - s * step_m.y(), s * step_m.x() + c * step_m.y()};
    const bool left = needle.pose.position_m().norm() > task_.task.dish_radius_m;
    const bool gone = needle.goal.position_m().norm() > task_.task.goal_radius_m();
    if (!left && !gone && random.uniform() >= config_.new_goal) continue;
    if (left || random.uniform() < kPoseToo) draw_pose(needle, random);
    draw_goal(needle, random);
  }
}

void ValueIterationLearner::learn(Shard& shard) const {
  const std::size_t rows = shard.needles.size();
  const auto columns = static_cast<std::size_t>(encoder_.size());
  constexpr auto kFeatures = static_cast<std::size_t>(inference::CostToGo::kFeatures);
  const std::size_t outputs = shard.actor_gradient.size() / rows;
  std::vector<const Decision*> drawn(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    drawn[i] = &shard.decisions[shard.random.below(shard.decisions.size())];
    std::copy(drawn[i]->observation.begin(), drawn[i]->observation.end(), &shard.observation[i * columns]);
    std::copy_n(drawn[i]->features, kFeatures, &shard.features[i * kFeatures]);
  }
  actor_.forward(shard.observation.data(), shard.actor);
  value_.forward(shard.features.data(), shard.value);
  const float* output = shard.actor.output.data_ptr<float>();
  const float* value = shard.value.output.data_ptr<float>();
  const double each = 1.0 / static_cast<double>(task_.environments);
  shard.value_loss = shard.actor_loss = shard.saturated = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    const Decision& decision = *drawn[i];
    shard.actor_loss += each * imitate(output + i * outputs, config_.proposals, decision.action, each,
                                       &shard.actor_gradient[i * outputs]);
    const double off = decision.still ? static_cast<double>(value[i]) - decision.cost : 0.0;
    shard.value_loss += each * off * off;
    shard.value_gradient[i] = static_cast<float>(2.0 * each * off);
    for (const double number : decision.action)
      if (std::abs(number) > static_cast<double>(kSaturatedAction))
        shard.saturated += each / static_cast<double>(task_.action.size);
  }
  using Wanted = FlatNetwork<float>::Wanted;
  actor_.backward(shard.observation.data(), shard.actor_gradient.data(), shard.actor, Wanted::kParameters);
  value_.backward(shard.features.data(), shard.value_gradient.data(), shard.value, Wanted::kParameters);
}

inference::Arrays ValueIterationLearner::actor_weights() const { return arrays_of(actor_); }

inference::Actor ValueIterationLearner::actor() const {
  return inference::Actor(actor_weights(), encoder_.size(), config_.hidden, task_.action.size, "actor",
                          config_.proposals);
}

std::optional<inference::CostToGo> ValueIterationLearner::cost_to_go() const { return judge_; }

common::Scalars ValueIterationLearner::take_statistics() {
  common::Scalars scalars;
  if (updates_summed_ > 0.0) {
    scalars.emplace_back(runs::curves::kCriticLoss, value_loss_sum_ / updates_summed_);
    scalars.emplace_back(runs::curves::kActorLoss, actor_loss_sum_ / updates_summed_);
    scalars.emplace_back(runs::curves::kTrainSaturation, saturated_sum_ / updates_summed_);
  }
  value_loss_sum_ = actor_loss_sum_ = saturated_sum_ = updates_summed_ = 0.0;
  return scalars;
}

void ValueIterationLearner::save(nets::Checkpoint& checkpoint) {
  nets::NamedTensors& networks = checkpoint.parts["networks"];
  networks = actor_.named(actor_.parameters(), "actor.");
  networks.merge(value_.named(value_.parameters(), "value."));
  networks.merge(target_.named(target_.parameters(), "target."));
  nets::NamedTensors& moments = checkpoint.parts["optimiser"];
  for (int k = 0; k < 2; ++k) {
    moments.merge(actor_.named(actor_moments_[k], "actor." + std::to_string(k) + "."));
    moments.merge(value_.named(value_moments_[k], "value." + std::to_string(k) + "."));
  }
  std::vector<double> needles, decisions;
  checkpoint.facts["random"] = common::Json::array();
  for (Shard& shard : shards_) {
    checkpoint.facts["random"].push_back(shard.random.save());
    for (Needle& needle : shard.needles)
      visit_needle(needle, [&](double& value) { needles.push_back(value); });
    for (Decision& decision : shard.decisions)
      visit_decision(decision, [&](double value) { decisions.push_back(value); });
  }
  const auto table = [](const std::vector<double>& numbers, std::int64_t rows) {
    return nets::tensor_from(numbers, {rows, static_cast<std::int64_t>(numbers.size()) / rows});
  };
  checkpoint.parts["running"] = {{"needles", table(needles, task_.environments)},
                                 {"decisions", table(decisions, task_.environments)}};
  checkpoint.facts["env_steps"] = env_steps_;
  checkpoint.facts["decisions"] = decisions_;
  checkpoint.facts["updates"] = updates_;
}

void ValueIterationLearner::load(const nets::Checkpoint& checkpoint) {
  const at::NoGradGuard no_grad;
  restore_numbers(checkpoint, "networks", "actor.", actor_, actor_.parameters());
  restore_numbers(checkpoint, "networks", "value.", value_, value_.parameters());
  restore_numbers(checkpoint, "networks", "target.", target_, target_.parameters());
  for (int k = 0; k < 2; ++k) {
    restore_numbers(checkpoint, "optimiser", "actor." + std::to_string(k) + ".", actor_, actor_moments_[k]);
    restore_numbers(checkpoint, "optimiser", "value." + std::to_string(k) + ".", value_, value_moments_[k]);
  }
  env_steps_ = checkpoint.facts.at("env_steps").get<std::int64_t>();
  decisions_ = checkpoint.facts.at("decisions").get<std::int64_t>();
  updates_ = checkpoint.facts.at("updates").get<std::int64_t>();
  const auto kept = static_cast<std::size_t>(std::clamp<std::int64_t>(decisions_, 0, config_.replayed));
  std::int64_t needle_numbers = 0, decision_numbers = 0;
  for (Shard& shard : shards_) {
    shard.decisions.resize(kept * shard.needles.size());
    for (Decision& decision : shard.decisions) {
      decision.observation.resize(static_cast<std::size_t>(encoder_.size()));
      decision.action.resize(task_.action.size);
    }
    for (Needle& needle : shard.needles) visit_needle(needle, [&](double&) { ++needle_numbers; });
    for (Decision& decision : shard.decisions) visit_decision(decision, [&](double&) { ++decision_numbers; });
  }
  const std::int64_t rows = task_.environments;
  const at::Tensor needles =
      tensor_of(checkpoint, "running", "needles", {rows, needle_numbers / rows}, at::kDouble).contiguous();
  const at::Tensor decisions =
      tensor_of(checkpoint, "running", "decisions", {rows, decision_numbers / rows}, at::kDouble)
          .contiguous();
  const double* number = needles.data_ptr<double>();
  const double* learned = decisions.data_ptr<double>();
  const common::Json& random = checkpoint.facts.at("random");
  if (random.size() != shards_.size())
    throw common::CheckpointError("training checkpoint: random streams of another number of environments");
  for (std::size_t i = 0; i < shards_.size(); ++i) {
    shards_[i].random.restore(random.at(i).get<std::string>());
    for (Needle& needle : shards_[i].needles) visit_needle(needle, [&](double& value) { value = *number++; });
    for (Decision& decision : shards_[i].decisions)
      visit_decision(decision, [&](double& value) { value = *learned++; });
  }
  renew_judge();
}

}  // namespace lodestone::rl
