#include "lodestone/rl/model_gradient_learner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <ATen/core/grad_mode.h>
#include <ATen/ops/zeros_like.h>

#include "lodestone/common/error.h"
#include "lodestone/env/mbs_env.h"
#include "lodestone/geometry/saturation.h"
#include "lodestone/nets/optimiser.h"
#include "lodestone/rl/policy_evaluation.h"
#include "lodestone/rl/proposals.h"
#include "lodestone/rl/training_checkpoint.h"
#include "lodestone/runs/curves.h"

namespace lodestone::rl {
namespace {

/// Fixed, so that results do not depend on the number of threads; its activations fit a core's cache.
constexpr std::int64_t kShardRows = 128;
constexpr std::size_t kNeedleNumbers = 19;
constexpr double kNewPose = 0.2;         // of the new goals, the share that comes with a new pose
constexpr float kFirstStrength = -1.0F;  // log odds
constexpr double kChoice = 0.1;          // of the logarithm of a cost: differences that matter
constexpr double kExplored = 0.1;        // share of the gradients and pulses of whatever proposal
constexpr double kStall_m = 2e-4;        // a shorter way is none
constexpr double kAlike = 0.25;   // of its strength: an action so near to one that stalled does so, too
constexpr double kNear_mm = 0.5;  // costs are weighed by their ratio, beyond this

/// Whether this action stalls as the one before did.
template <class Needle>
bool stalls_again(const Needle& needle, const geometry::Vector2& action) {
  const double strength = needle.stalled.norm();
  return strength > 0.0 && (action - needle.stalled).norm() < kAlike * strength;
}

/// The numbers of a needle in the order checkpoints hold them.
template <class Needle, class Visit>
void visit_numbers(Needle& needle, Visit&& visit) {
  for (auto* value :
       {&needle.pose.x_m, &needle.pose.y_m, &needle.pose.heading_rad, &needle.target_m.x(),
        &needle.target_m.y(), &needle.target_step_m.x(), &needle.target_step_m.y(), &needle.told.log_mean,
        &needle.told.log_sigma, &needle.log_gain, &needle.log_place, &needle.place_m.x(), &needle.place_m.y(),
        &needle.stalled.x(), &needle.stalled.y(), &needle.last_action[0], &needle.last_action[1],
        &needle.last_displacement_m.x(), &needle.last_displacement_m.y()})
    visit(*value);
}

}  // namespace

ModelGradientLearner::Shard::Shard(std::uint64_t seed, std::size_t index, std::int64_t rows)
    : random(seed, "model gradient", index), needles(static_cast<std::size_t>(rows)) {}

ModelGradientLearner::ModelGradientLearner(const LearningConfig& learning, const ModelGradientConfig& config,
                                           const ImaginedTask& task, inference::DynamicsModel model,
                                           std::uint64_t seed, std::int64_t threads)
    : learning_(learning),
      config_(config),
      task_(task),
      encoder_(task.encoder),
      model_(std::move(model)),
      starts_(env::starts_within(model_, task.task.start_radius_m(), task.region.get())),
      actor_(layer_widths(encoder_.size(), config_.hidden, inference::Actor::outputs(2, config_.proposals))),
      pool_(static_cast<std::size_t>(threads)) {
  if (model_.config.components == 0)
    throw common::ConfigError(
        "method = \"model_gradient\", but the dynamics predict single values; train them with "
        "model.components of 1 or more");
  if (task.encoder.target_heading || task.task.goal == task::GoalKind::kPose)
    throw common::ConfigError(
        "method = \"model_gradient\" knows no headings to be reached: set encoder.target_heading to "
        "false and task.goal to centre or point");
  common::RandomStream random(seed, "actor", 0);
  actor_.initialise(random);
  set_proposals_apart(actor_, config.hidden.size(), 2, config.proposals, kFirstStrength);
  first_moment_ = at::zeros_like(actor_.parameters());
  second_moment_ = at::zeros_like(actor_.parameters());
  gradient_ = at::zeros_like(actor_.parameters());
  const DistanceCost cost{config.goal_radius_m, task.task.dish_radius_m};
  for (const inference::FoldedDynamics& member : model_.members) simulators_.emplace_back(member, cost);
  for (std::int64_t first = 0; first < task.environments; first += kShardRows) {
    const std::int64_t rows = std::min(kShardRows, task.environments - first);
    Shard& shard = shards_.emplace_back(seed, shards_.size(), rows);
    shard.actor = actor_.workspace(rows);
    shard.distance = simulators_.front().workspace(rows);
    const auto count = static_cast<std::size_t>(rows);
    shard.observation.resize(count * static_cast<std::size_t>(encoder_.size()));
    shard.output_gradient.resize(static_cast<std::size_t>(shard.actor.output.numel()));
    shard.tried.resize(count);
    shard.chosen.resize(count);
    shard.each_mm.resize(count * static_cast<std::size_t>(config.proposals + 1));
    shard.state.resize(count * static_cast<std::size_t>(data::state_size(model_.info.layout)));
    for (std::vector<double>* pairs : {&shard.drive, &shard.target_m, &shard.gradient})
      pairs->resize(2 * count);
    shard.cost_mm.resize(count);
    for (Needle& needle : shard.needles) {
      draw_pose(needle, shard.random);
      draw_goal(needle, shard.random);
    }
  }
}

double ModelGradientLearner::progress() const {
  return std::min(1.0, static_cast<double>(env_steps_) / static_cast<double>(learning_.env_steps));
}

void ModelGradientLearner::draw_pose(Needle& needle, common::RandomStream& random) const {
  needle.put(starts_[random.below(starts_.size())], config_, random);
  needle.stalled.setZero();
}

void ModelGradientLearner::draw_goal(Needle& needle, common::RandomStream& random) const {
  const task::TaskConfig& task = task_.task;
  needle.target_m = task::draw_goal(task, random, task_.region.get()).position_m;
  needle.target_step_m.setZero();
  if (task.goal == task::GoalKind::kPoint && random.uniform() < config_.near_goals) {
    if (const auto near_m = draw_near_m(needle.pose.position_m(), task_, random)) needle.target_m = *near_m;
  }
  if (task.goal == task::GoalKind::kPoint && random.uniform() < 0.5) {
    const double step_m = config_.most_target_step_m * random.uniform();
    const double angle_rad = random.uniform(-geometry::kPi, geometry::kPi);
    needle.target_step_m = step_m * geometry::Vector2(std::cos(angle_rad), std::sin(angle_rad));
  }
  needle.draw_rig(config_, random);
}

void ModelGradientLearner::step() {
  const at::NoGradGuard no_grad;
  pool_.for_each(shards_.size(), [this](std::size_t index) {
    const auto turn = static_cast<std::size_t>(updates_) + index;
    work_on(shards_[index], simulators_[turn % simulators_.size()]);
  });
  gradient_.zero_();
  for (Shard& shard : shards_) {
    gradient_.add_(shard.actor.gradient);
    loss_mm_sum_ += shard.loss_mm;
    saturated_sum_ += shard.saturated;
  }
  steps_summed_ += static_cast<double>(task_.environments);
  if (!std::isfinite(loss_mm_sum_))
    throw common::Error("training the policy diverged at environment step " + std::to_string(env_steps_) +
                        " (its loss is not finite); lower model_gradient.learning_rate");
  ++updates_;
  const double rate = config_.learning_rate * (1.0 - (1.0 - learning_.final_learning_rate) * progress());
  nets::adam_step(actor_.parameters().data_ptr<float>(), gradient_.data_ptr<float>(),
                  first_moment_.data_ptr<float>(), second_moment_.data_ptr<float>(),
                  static_cast<std::size_t>(gradient_.numel()), rate, updates_);
  env_steps_ += task_.environments;
}

void ModelGradientLearner::observe(Shard& shard) const {
  const auto columns = static_cast<std::size_t>(encoder_.size());
  const auto size = shard.state.size() / shard.needles.size();
  task::Observation seen;
  for (std::size_t i = 0; i < shard.needles.size(); ++i) {
    const Needle& needle = shard.needles[i];
    const geometry::Vector2 after_m = needle.target_m + needle.target_step_m;
    seen.pose = needle.pose;
    seen.pose.x_m += task_.pose_noise_m * shard.random.normal();
    seen.pose.y_m += task_.pose_noise_m * shard.random.normal();
    seen.pose.heading_rad =
        geometry::wrap_angle(seen.pose.heading_rad + task_.heading_noise_rad * shard.random.normal());
    seen.target_m = needle.target_m;
    seen.ahead = {{after_m, 1.0}};
    seen.drive_gain = needle.told;
    seen.last_action = needle.last_action;
    seen.last_displacement_m = needle.last_displacement_m;
    encoder_.encode(seen, &shard.observation[i * columns]);
    shard.state[i * size] = needle.pose.x_m;
    shard.state[i * size + 1] = needle.pose.y_m;
    if (size == 3) shard.state[i * size + 2] = needle.pose.heading_rad;
    shard.target_m[2 * i] = after_m.x();
    shard.target_m[2 * i + 1] = after_m.y();
  }
}

void ModelGradientLearner::evaluate(Shard& shard, const ExpectedDistance& simulator,
                                    const std::vector<geometry::Vector2>& action, double turn_rad,
                                    bool gradient) const {
  const std::size_t count = shard.needles.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double factor = shard.needles[i].factor();
    const geometry::Vector2 drive =
        geometry::saturated(factor * task::drive_of(action[i], task_.action), task_.action.scale);
    shard.drive[2 * i] = drive.x();
    shard.drive[2 * i + 1] = drive.y();
  }
  simulator.evaluate(shard.state.data(), shard.drive.data(), shard.target_m.data(), turn_rad,
                     shard.cost_mm.data(), gradient ? shard.gradient.data() : nullptr, shard.distance);
  for (std::size_t i = 0; i < count; ++i)
    shard.cost_mm[i] += config_.current_cost_mm * action[i].squaredNorm();
}

void ModelGradientLearner::work_on(Shard& shard, const ExpectedDistance& simulator) const {
  observe(shard);
  actor_.forward(shard.observation.data(), shard.actor);
  const float* output = shard.actor.output.data_ptr<float>();
  const std::size_t count = shard.needles.size();
  const auto proposals = static_cast<std::size_t>(config_.proposals);
  const std::size_t outputs = shard.output_gradient.size() / count;
  const DistanceCost rest{config_.goal_radius_m, task_.task.dish_radius_m};
  const auto proposal = [&](std::size_t i, std::size_t k) {
    float action[2];
    inference::Actor::propose(output + i * outputs, 2, static_cast<std::int64_t>(k), action);
    return geometry::Vector2(action[0], action[1]);
  };
  std::vector<double> rest_mm(count);
  for (std::size_t i = 0; i < count; ++i)
    rest_mm[i] =
        rest.at(shard.needles[i].pose.position_m(), {shard.target_m[2 * i], shard.target_m[2 * i + 1]});
  const double turn_rad = shard.random.uniform(0.0, geometry::kPi);
  for (std::size_t k = 0; k < proposals; ++k) {
    for (std::size_t i = 0; i < count; ++i) shard.tried[i] = proposal(i, k);
    evaluate(shard, simulator, shard.tried, turn_rad, false);
    for (std::size_t i = 0; i < count; ++i) {
      const double stalled_mm = rest_mm[i] + config_.current_cost_mm * shard.tried[i].squaredNorm();
      shard.each_mm[i * (proposals + 1) + k] =
          stalls_again(shard.needles[i], shard.tried[i]) ? stalled_mm : shard.cost_mm[i];
    }
  }
  const double each = 1.0 / static_cast<double>(task_.environments);
  std::fill(shard.output_gradient.begin(), shard.output_gradient.end(), 0.0F);
  shard.loss_mm = shard.saturated = 0.0;
  std::vector<double> right(proposals + 1), given(proposals + 1);
  for (std::size_t i = 0; i < count; ++i) {
    double* cost_mm = &shard.each_mm[i * (proposals + 1)];
    cost_mm[proposals] = rest_mm[i];
    const double least_mm = *std::min_element(cost_mm, cost_mm + proposals + 1);
    const float* score = output + i * outputs + 3 * proposals;
    const float most = *std::max_element(score, score + proposals + 1);
    double right_sum = 0.0, given_sum = 0.0;
    for (std::size_t k = 0; k <= proposals; ++k) {
      right_sum += right[k] = std::pow((kNear_mm + least_mm) / (kNear_mm + cost_mm[k]), 1.0 / kChoice);
      given_sum += given[k] = std::exp(static_cast<double>(score[k] - most));
    }
    float* by_score = &shard.output_gradient[i * outputs + 3 * proposals];
    for (std::size_t k = 0; k <= proposals; ++k)
      by_score[k] = static_cast<float>(each * (given[k] / given_sum - right[k] / right_sum));
    // Which of them learns: mostly the best, sometimes any.
    std::size_t learns = shard.random.below(proposals);
    if (shard.random.uniform() >= kExplored) {
      double left = shard.random.uniform() * (right_sum - right[proposals]);
      learns = 0;
      while (learns + 1 < proposals && left >= right[learns]) left -= right[learns++];
    }
    shard.chosen[i] = static_cast<std::int64_t>(learns);
    shard.tried[i] = proposal(i, learns);
    const auto gives = static_cast<std::size_t>(std::max_element(score, score + proposals + 1) - score);
    shard.loss_mm += cost_mm[gives];
  }
  evaluate(shard, simulator, shard.tried, turn_rad, true);
  for (std::size_t i = 0; i < count; ++i) {
    const double gain = shard.needles[i].factor() * task_.action.scale;
    const std::size_t first = i * outputs + 3 * static_cast<std::size_t>(shard.chosen[i]);
    const geometry::Vector2 towards(output[first], output[first + 1]);
    const double length = std::max(1e-6, towards.norm());
    const geometry::Vector2 direction = towards / length;
    const double odds = 1.0 / (1.0 + std::exp(-static_cast<double>(output[first + 2])));
    const double strength = std::sqrt(2.0) * odds;
    geometry::Vector2 by_action;
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const double a = shard.tried[i][axis];
      const double drive = shard.drive[2 * i + static_cast<std::size_t>(axis)];
      const bool acts = drive != 0.0 && std::abs(drive) < task_.action.scale;
      by_action[axis] = (acts ? gain * shard.gradient[2 * i + static_cast<std::size_t>(axis)] : 0.0) +
                        2.0 * config_.current_cost_mm * a;
      if (std::abs(strength * direction[axis]) > 1.0)
        by_action[axis] = std::max(0.0, by_action[axis] * a) / a;  // only back inside
      if (std::abs(a) > static_cast<double>(kSaturatedAction)) shard.saturated += 0.5;
    }
    const geometry::Vector2 away = shard.tried[i] - shard.needles[i].stalled;
    if (stalls_again(shard.needles[i], shard.tried[i]))  // what it costs falls where it is another one
      by_action = -std::max(0.0, rest_mm[i] - shard.cost_mm[i]) /
                  (kAlike * shard.needles[i].stalled.norm() * std::max(1e-6, away.norm())) * away;
    by_action *= each / (kNear_mm + shard.cost_mm[i]);
    const geometry::Vector2 across = by_action - by_action.dot(direction) * direction;
    shard.output_gradient[first] = static_cast<float>(strength / length * across.x());
    shard.output_gradient[first + 1] = static_cast<float>(strength / length * across.y());
    shard.output_gradient[first + 2] = static_cast<float>(by_action.dot(direction) * strength * (1.0 - odds));
  }
  actor_.backward(shard.observation.data(), shard.output_gradient.data(), shard.actor,
                  FlatNetwork<float>::Wanted::kParameters);
  give_pulses(shard, simulator);
}

void ModelGradientLearner::give_pulses(Shard& shard, const ExpectedDistance& simulator) const {
  const float* output = shard.actor.output.data_ptr<float>();
  const std::size_t count = shard.needles.size();
  const std::size_t outputs = shard.output_gradient.size() / count;
  const std::size_t size = shard.state.size() / count;
  for (std::size_t i = 0; i < count; ++i) {
    float action[2] = {};
    shard.chosen[i] = inference::Actor::choose(output + i * outputs, 2, config_.proposals);
    if (shard.chosen[i] < config_.proposals)
      inference::Actor::propose(output + i * outputs, 2, shard.chosen[i], action);
    // Sometimes the pulse that was learned from, whatever was chosen.
    if (shard.random.uniform() >= kExplored)
      shard.tried[i] = {action[0], action[1]};
    else
      shard.chosen[i] = 0;
  }
  evaluate(shard, simulator, shard.tried, 0.0, false);
  for (std::size_t i = 0; i < count; ++i) {
    Needle& needle = shard.needles[i];
    const geometry::Vector2 before_m = needle.pose.position_m();
    const bool rests = shard.chosen[i] == config_.proposals;
    if (!rests && !stalls_again(needle, shard.tried[i])) {
      double next[3];
      simulator.draw(static_cast<std::int64_t>(i), &shard.state[i * size], shard.random, next,
                     shard.distance);
      needle.pose = {next[0], next[1], size == 3 ? next[2] : 0.0};
      const bool stalled = (needle.pose.position_m() - before_m).norm() < kStall_m;
      needle.stalled = stalled ? shard.tried[i] : geometry::Vector2(geometry::Vector2::Zero());
    }
    needle.note_pulse(shard.tried[i], before_m, config_, shard.random);
    needle.target_m += needle.target_step_m;
    const bool left = needle.pose.position_m().norm() > task_.task.dish_radius_m;
    const bool gone = needle.target_m.norm() > std::max(task_.task.goal_radius_m(), 1e-9);
    if (!left && !gone && shard.random.uniform() >= config_.new_goal) continue;
    if (left || shard.random.uniform() < kNewPose) draw_pose(needle, shard.random);
    draw_goal(needle, shard.random);
  }
}

inference::Arrays ModelGradientLearner::actor_weights() const { return arrays_of(actor_); }

inference::Actor ModelGradientLearner::actor() const {
  return inference::Actor(actor_weights(), encoder_.size(), config_.hidden, 2, "actor", config_.proposals);
}

common::Scalars ModelGradientLearner::take_statistics() {
  common::Scalars scalars;
  if (steps_summed_ > 0.0) {
    scalars.emplace_back(runs::curves::kActorLoss, loss_mm_sum_ / steps_summed_);
    scalars.emplace_back(runs::curves::kTrainSaturation, saturated_sum_ / steps_summed_);
  }
  loss_mm_sum_ = saturated_sum_ = steps_summed_ = 0.0;
  return scalars;
}

void ModelGradientLearner::save(nets::Checkpoint& checkpoint) {
  checkpoint.parts["networks"] = actor_.named(actor_.parameters(), "actor.");
  nets::NamedTensors moments = actor_.named(first_moment_, "actor.first_moment.");
  moments.merge(actor_.named(second_moment_, "actor.second_moment."));
  checkpoint.parts["optimiser"] = std::move(moments);
  std::vector<double> numbers;
  checkpoint.facts["random"] = common::Json::array();
  for (const Shard& shard : shards_) {
    checkpoint.facts["random"].push_back(shard.random.save());
    for (const Needle& needle : shard.needles)
      visit_numbers(needle, [&](double value) { numbers.push_back(value); });
  }
  const auto columns = static_cast<std::int64_t>(kNeedleNumbers);
  checkpoint.parts["running"] = {{"needles", nets::tensor_from(numbers, {task_.environments, columns})}};
  checkpoint.facts["env_steps"] = env_steps_;
  checkpoint.facts["updates"] = updates_;
}

void ModelGradientLearner::load(const nets::Checkpoint& checkpoint) {
  const at::NoGradGuard no_grad;
  restore_numbers(checkpoint, "networks", "actor.", actor_, actor_.parameters());
  restore_numbers(checkpoint, "optimiser", "actor.first_moment.", actor_, first_moment_);
  restore_numbers(checkpoint, "optimiser", "actor.second_moment.", actor_, second_moment_);
  const auto columns = static_cast<std::int64_t>(kNeedleNumbers);
  const at::Tensor needles =
      tensor_of(checkpoint, "running", "needles", {task_.environments, columns}, at::kDouble).contiguous();
  const double* number = needles.data_ptr<double>();
  const common::Json& random = checkpoint.facts.at("random");
  if (random.size() != shards_.size())
    throw common::CheckpointError("training checkpoint: random streams of another number of environments");
  for (std::size_t i = 0; i < shards_.size(); ++i) {
    shards_[i].random.restore(random.at(i).get<std::string>());
    for (Needle& needle : shards_[i].needles)
      visit_numbers(needle, [&](double& value) { value = *number++; });
  }
  env_steps_ = checkpoint.facts.at("env_steps").get<std::int64_t>();
  updates_ = checkpoint.facts.at("updates").get<std::int64_t>();
}

}  // namespace lodestone::rl
