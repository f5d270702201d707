#include "lodestone/rl/policy_trainer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "lodestone/common/artefact.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/common/metrics.h"
#include "lodestone/common/resource_use.h"
#include "lodestone/inference/policy.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/rl/hindsight.h"
#include "lodestone/rl/policy_learner.h"
#include "lodestone/rl/td3.h"
#include "lodestone/runs/curves.h"
#include "lodestone/runs/resumable_run.h"

namespace lodestone::rl {
namespace {

constexpr const char* kKind = "policy_training";

std::string note(const PolicyScore& score) {
  char text[128];
  std::snprintf(text, sizeof text, "return %.2f, success %.0f %%, episodes end %.2f mm off",
                score.episode_return, 100.0 * score.success_rate, score.episode_end_error_mm);
  return text;
}

/// Throws CheckpointError where another version wrote it.
PolicyScore score_from(const common::Json& json, const std::string& training) {
  try {
    return common::artefact_from_json<PolicyScore>(json, "best");
  } catch (const common::DataError& error) {
    throw common::CheckpointError(training + " is of another version and cannot be gone on with (" +
                                  error.what() + "): train anew");
  }
}

/// Adds the time since it was made to what a result has had before.
class Stopwatch {
 public:
  Stopwatch(const common::SteadyClock& clock, const runs::PolicyResult& result)
      : clock_(clock),
        wall_s_(result.train_seconds - clock.now_s()),
        processor_s_(result.processor_seconds.value_or(0.0) - common::processor_seconds()) {}

  void read(runs::PolicyResult& result) const {
    result.train_seconds = wall_s_ + clock_.now_s();
    result.processor_seconds = processor_s_ + common::processor_seconds();
  }

 private:
  const common::SteadyClock& clock_;
  double wall_s_, processor_s_;
};

/// One run: the learner, the policy that is kept so far, and the files.
class Training : public runs::ResumableWork {
 public:
  Training(const TrainPolicyConfig& config, PolicyLearner& learner, const ScoringEnvironments& scoring,
           const std::string& folder, const task::Region* region)
      : config_(config),
        folder_(folder),
        evaluation_(scoring.choice, config.encoder),
        fresh_(scoring.fresh, config.encoder),
        learner_(learner),
        next_evaluation_(config.training.evaluate_every) {
    if (region != nullptr) region_ = *region;
  }

  void load(const std::string& folder) override {
    const nets::Checkpoint checkpoint = nets::load_checkpoint(folder + "/training", kKind);
    try {
      const common::Json& run = checkpoint.facts.at("run");
      next_evaluation_ = run.at("next_evaluation").get<std::int64_t>();
      result_.train_seconds = run.at("train_seconds").get<double>();
      result_.processor_seconds = run.at("processor_seconds").get<double>();
      if (run.contains("other_processor_seconds"))
        result_.other_processor_seconds = run.at("other_processor_seconds").get<double>();
      result_.best_env_steps = run.at("best_env_steps").get<std::int64_t>();
      returns_ = run.at("returns").get<std::vector<std::pair<double, double>>>();
      if (returns_.empty()) throw common::CheckpointError(folder + "/training: no evaluation is in it");
      if (result_.best_env_steps > 0)
        result_.best_evaluation = score_from(run.at("best"), folder + "/training");
      learner_.load(checkpoint);
    } catch (const nlohmann::json::exception& error) {
      throw common::CheckpointError(folder + "/training: malformed facts: " + error.what());
    }
  }

  runs::Progress progress() const override {
    return {learner_.env_steps(), config_.training.learning.env_steps, learner_.finished() || out_of_time(),
            text_};
  }

  void step(common::MetricsLog& metrics) override {
    if (!others_before_s_) begin_to_watch_others();
    const Stopwatch watch(clock_, result_);
    if (returns_.empty()) evaluate(metrics);  // where learning starts from
    learner_.step();
    watch.read(result_);
    if (learner_.env_steps() >= next_evaluation_ || learner_.finished() || out_of_time()) {
      while (next_evaluation_ <= learner_.env_steps()) next_evaluation_ += config_.training.evaluate_every;
      evaluate(metrics);
      watch.read(result_);
      watch_others();
    }
  }

  void save(const std::string& folder) override {
    nets::Checkpoint checkpoint;
    checkpoint.kind = kKind;
    checkpoint.config = common::config_to_json(config_);
    learner_.save(checkpoint);
    watch_others();
    checkpoint.facts["run"] = {{"next_evaluation", next_evaluation_},
                               {"train_seconds", result_.train_seconds},
                               {"processor_seconds", result_.processor_seconds.value_or(0.0)},
                               {"best_env_steps", result_.best_env_steps},
                               {"returns", returns_}};
    if (result_.other_processor_seconds)
      checkpoint.facts["run"]["other_processor_seconds"] = *result_.other_processor_seconds;
    if (result_.best_evaluation)
      checkpoint.facts["run"]["best"] = common::artefact_to_json(*result_.best_evaluation);
    nets::save_checkpoint(folder + "/training", checkpoint);
  }

  /// Scores what was kept, by episodes that nothing was chosen by.
  void score_afresh() {
    const inference::Policy kept = inference::load_policy(folder_ + "/checkpoint");
    result_.fresh_evaluation = fresh_.run(kept.actor());
    keep(kept);
  }

  runs::PolicyResult result() {
    result_.env_steps = learner_.env_steps();
    result_.updates = learner_.updates();
    result_.seconds_to_95_percent = seconds_to_fraction(0.95);
    result_.peak_memory_mb = common::peak_memory_mb();
    if (config_.method == Method::kTd3)
      result_.products = common::name_of(products_here(config_.td3.products));
    if (result_.fresh_evaluation) result_.success_rate = result_.fresh_evaluation->success_rate;
    return result_;
  }

 private:
  bool out_of_time() const {
    return config_.training.max_seconds > 0.0 && result_.train_seconds >= config_.training.max_seconds;
  }

  void begin_to_watch_others() {
    if (result_.train_seconds > 0.0 && !result_.other_processor_seconds) return;  // nobody saw its beginning
    others_before_s_ =
        common::other_processor_seconds().value_or(0.0) - result_.other_processor_seconds.value_or(0.0);
  }
  void watch_others() {
    const std::optional<double> now_s = common::other_processor_seconds();
    if (now_s && others_before_s_)
      result_.other_processor_seconds = std::max(0.0, *now_s - *others_before_s_);
  }

  void evaluate(common::MetricsLog& metrics) {
    const PolicyScore score = evaluation_.run(learner_.actor());
    if (!std::isfinite(score.episode_return))
      throw common::DataError("training the policy: the return of its evaluation is " +
                              std::to_string(score.episode_return) + " at environment step " +
                              std::to_string(learner_.env_steps()) +
                              "; check the dynamics with `lodestone evaluate dynamics`");
    common::Scalars scalars = learner_.take_statistics();
    for (const auto& [key, value] : scalars_of(score)) scalars.emplace_back(key, value);
    scalars.emplace_back("train/updates", static_cast<double>(learner_.updates()));
    scalars.emplace_back(runs::curves::kTrainSeconds, result_.train_seconds);
    scalars.emplace_back(runs::curves::kProcessorSeconds, result_.processor_seconds.value_or(0.0));
    if (result_.train_seconds > 0.0) {
      scalars.emplace_back("train/steps_per_s",
                           static_cast<double>(learner_.env_steps()) / result_.train_seconds);
    }
    metrics.write(learner_.env_steps(), scalars);
    returns_.emplace_back(result_.train_seconds, score.episode_return);
    text_ = note(score);
    if (learner_.env_steps() == 0) return;
    // Of a cost-to-go the policy's score does not tell: the latest is kept, and the policy with it.
    const bool latest = learner_.cost_to_go().has_value();
    if (latest || !result_.best_evaluation ||
        score.episode_return > result_.best_evaluation->episode_return) {
      result_.best_evaluation = score;
      result_.best_env_steps = learner_.env_steps();
      keep(present_policy());
    }
  }

  double seconds_to_fraction(double fraction) const {
    if (returns_.size() < 2) return 0.0;
    const double first = returns_.front().second;
    const double wanted = first + fraction * (returns_.back().second - first);
    const auto reached = std::find_if(returns_.begin() + 1, returns_.end() - 1,
                                      [wanted](const auto& entry) { return entry.second >= wanted; });
    return reached->first;
  }

  inference::Policy present_policy() const {
    inference::Policy policy;
    policy.weights = learner_.actor_weights();
    policy.hidden = config_.hidden();
    policy.proposals = config_.proposals();
    policy.cost_to_go = learner_.cost_to_go();
    policy.encoder = config_.encoder;
    policy.action = config_.action;
    policy.rig = config_.learned_rig;
    policy.goal = common::name_of(config_.task.goal);
    policy.region = region_;
    return policy;
  }

  void keep(const inference::Policy& policy) const {
    common::Json metrics = {{"env_steps", result_.best_env_steps},
                            {"best_evaluation", common::artefact_to_json(*result_.best_evaluation)}};
    if (result_.fresh_evaluation)
      metrics["fresh_evaluation"] = common::artefact_to_json(*result_.fresh_evaluation);
    inference::save_policy(folder_ + "/checkpoint", policy, common::config_to_json(config_), metrics);
  }

  TrainPolicyConfig config_;
  std::string folder_;
  PolicyEvaluation evaluation_;
  PolicyEvaluation fresh_;
  PolicyLearner& learner_;
  common::SteadyClock clock_;
  std::optional<double> others_before_s_;
  std::int64_t next_evaluation_;
  std::vector<std::pair<double, double>> returns_;  // of every evaluation: training time in s, mean return
  runs::PolicyResult result_;
  std::optional<task::Region> region_;
  std::string text_ = "warming up";
};

}  // namespace

void TrainPolicyConfig::validate() const {
  for (const auto& [key, layers] : {std::pair{"td3.hidden", td3.hidden},
                                    {"model_gradient.hidden", model_gradient.hidden},
                                    {"value_iteration.hidden", value_iteration.hidden},
                                    {"value_iteration.value_hidden", value_iteration.value_hidden}})
    if (layers.size() > inference::kMostLayers)
      throw common::InvalidConfig(key, layers,
                                  "name at most " + std::to_string(inference::kMostLayers) + " layers");
  const LearningConfig& learning = training.learning;
  if (method != Method::kTd3) {
    if (simulator != Simulator::kMbs)
      throw common::InvalidConfig(
          "method", common::name_of(method),
          "be td3 with simulator = physics: the other methods look into the learned simulator");
    if (replay.environments > 0)
      throw common::InvalidConfig(
          "replay.environments", replay.environments,
          "be 0 with method = " + common::name_of(method) + ", which learns from no recorded steps");
    if (learning.hindsight > 0.0)
      throw common::InvalidConfig(
          "training.hindsight", learning.hindsight,
          "be 0 with method = " + common::name_of(method) + ", which keeps no steps to relabel");
    if (action.dead_band > 0.0)
      throw common::InvalidConfig(
          "action.dead_band", action.dead_band,
          "be 0 with method = " + common::name_of(method) + ", which learns by itself when to rest");
    return;
  }
  if (learning.warm_up_steps >= learning.env_steps)
    throw common::InvalidConfig("training.warm_up_steps", learning.warm_up_steps,
                                "be below training.env_steps = " + std::to_string(learning.env_steps));
  if (replay.environments > training.environments)
    throw common::InvalidConfig(
        "replay.environments", replay.environments,
        "not exceed training.environments = " + std::to_string(training.environments));
  if (replay.environments > 0 && recorded.empty())
    throw common::InvalidConfig("replay.environments", replay.environments,
                                "be 0 without a recording; name one: --set recorded=FILE.h5");
  if (learning.hindsight > 0.0) Hindsight::check(task, encoder);
  if (td3.products != Td3Products::kFloat32 && td3.backend != Td3Backend::kFused)
    throw common::InvalidConfig("td3.products", common::name_of(td3.products),
                                "be float32 with td3.backend = autograd");
  if (td3.batch_size > learning.buffer_size)
    throw common::InvalidConfig("training.buffer_size", learning.buffer_size,
                                "be at least td3.batch_size = " + std::to_string(td3.batch_size));
}

TrainPolicyConfig adopt_rig(TrainPolicyConfig config) {
  env::adopt_rig(config.rig, config.task, config.encoder, config.action);
  config.learned_rig = common::config_to_json(config.rig);
  return config;
}

TrainPolicyConfig adopt_data(TrainPolicyConfig config, const data::DatasetInfo& info) {
  env::adopt_data(info, config.task, config.encoder, config.action);
  config.learned_rig = info.rig;
  return config;
}

runs::RunRequest run_request(const TrainPolicyConfig& config, const std::string& folder, bool resume) {
  runs::RunRequest request;
  request.folder = folder;
  request.verb = "train-policy";
  request.config = common::config_to_json(config);
  request.seed = config.seed;
  request.resume = resume;
  // Folders may be moved: what they hold counts.
  request.free_keys = {"threads", "recorded", "dynamics", "training.checkpoint_every_s"};
  request.length_keys = {"training.env_steps", "training.max_seconds"};
  request.inputs = runs::named_inputs(request.config, {"dynamics", "recorded"});
  return request;
}

runs::PolicyResult train_policy(const TrainPolicyConfig& config, PolicyLearner& learner,
                                const ScoringEnvironments& scoring, runs::RunFolder& run,
                                const task::Region* region) {
  Training work(config, learner, scoring, run.path(), region);
  runs::run_resumably(run, work,
                      {"training the policy", "environment steps", config.training.checkpoint_every_s});
  work.score_afresh();
  return work.result();
}

}  // namespace lodestone::rl
