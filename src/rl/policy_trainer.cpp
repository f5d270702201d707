#include "lodestone/rl/policy_trainer.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <thread>
#include <utility>
#include <vector>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/memory.h"
#include "lodestone/common/metrics.h"
#include "lodestone/common/progress.h"
#include "lodestone/inference/policy.h"
#include "lodestone/nets/checkpoint.h"
#include "lodestone/rl/policy_learner.h"

namespace lodestone::rl {
namespace {

constexpr const char* kKind = "td3_training";

std::int64_t thread_count(std::int64_t asked) {
  return asked > 0 ? asked : std::max<std::int64_t>(1, std::thread::hardware_concurrency());
}

/// The part of a configuration that decides the result.
common::Json reproducibility_settings(TrainPolicyConfig config) {
  config.threads = 0;
  config.recorded.clear();
  config.dynamics.clear();  // folders may be moved; the environments' state says when the model is another
  config.training.checkpoint_every_s = 0.0;
  config.training.max_seconds = 0.0;
  return common::config_to_json(config);
}

common::Json score_to_json(const PolicyScore& score) { return score.json(); }

PolicyScore score_from_json(const common::Json& json) {
  PolicyScore score;
  score.episode_return = json.at("episode_return").get<double>();
  score.success_rate = json.at("success_rate").get<double>();
  score.final_error_mm = json.at("final_error_mm").get<double>();
  score.final_error_median_mm = json.at("final_error_median_mm").get<double>();
  score.episode_length = json.at("episode_length").get<double>();
  score.action_saturation = json.at("action_saturation").get<double>();
  score.episodes = json.at("episodes").get<std::int64_t>();
  return score;
}

std::string note(const PolicyScore& score) {
  char text[128];
  std::snprintf(text, sizeof text, "return %.2f, success %.0f %%, error %.2f mm", score.episode_return,
                100.0 * score.success_rate, score.final_error_mm);
  return text;
}

std::optional<Hindsight> hindsight(const TrainPolicyConfig& config) {
  const double fraction = config.training.learning.hindsight;
  if (fraction <= 0.0) return std::nullopt;
  return Hindsight(fraction, config.task, config.encoder, config.training.environments,
                   static_cast<std::uint64_t>(config.seed));
}

/// One run: the learner, its best policy so far, and the files.
class Run {
 public:
  Run(const TrainPolicyConfig& config, env::VecEnv& training, env::VecEnv& evaluation,
      const std::string& folder, const task::Region* region)
      : config_(config),
        folder_(folder),
        evaluation_(evaluation, config.encoder),
        learner_(config.training.learning, config.td3, config.noise, static_cast<std::uint64_t>(config.seed),
                 thread_count(config.threads), training, hindsight(config)),
        log_(folder),
        next_evaluation_(config.training.evaluate_every) {
    if (region != nullptr) region_ = *region;
  }

  void resume() {
    const nets::Checkpoint checkpoint = nets::load_checkpoint(folder_ + "/training", kKind);
    if (checkpoint.config != reproducibility_settings(config_)) {
      throw common::ConfigError("--resume: the configuration differs from that of " + folder_ +
                                "/training; use the same --config and --set as before, or another --out");
    }
    learner_.load(checkpoint);
    try {
      const common::Json& run = checkpoint.facts.at("run");
      next_evaluation_ = run.at("next_evaluation").get<std::int64_t>();
      result_.train_seconds = run.at("train_seconds").get<double>();
      result_.best_env_steps = run.at("best_env_steps").get<std::int64_t>();
      returns_ = run.at("returns").get<std::vector<std::pair<double, double>>>();
      if (result_.best_env_steps > 0) result_.evaluation = score_from_json(run.at("best"));
    } catch (const nlohmann::json::exception& error) {
      throw common::CheckpointError(folder_ + "/training: malformed run facts: " + error.what());
    }
  }

  PolicyRunResult train() {
    const common::SteadyClock clock;
    const double earlier_s = result_.train_seconds;
    const double start_s = clock.now_s();
    double saved_s = start_s;
    common::Progress progress("training the policy", config_.training.learning.env_steps);
    std::string text = "warming up";
    if (returns_.empty()) evaluate();  // where learning starts from
    while (!learner_.finished()) {
      learner_.step();
      const double now_s = clock.now_s();
      result_.train_seconds = earlier_s + now_s - start_s;
      if (learner_.env_steps() >= next_evaluation_ || learner_.finished()) {
        while (next_evaluation_ <= learner_.env_steps()) next_evaluation_ += config_.training.evaluate_every;
        text = note(evaluate());
      }
      progress.update(learner_.env_steps(), text);
      if (common::interrupted()) stop();
      if (config_.training.max_seconds > 0.0 && result_.train_seconds >= config_.training.max_seconds) {
        if (!learner_.finished()) text = note(evaluate());
        common::log_info("train-policy: max_seconds reached after " + std::to_string(learner_.env_steps()) +
                         " environment steps");
        break;
      }
      if (now_s - saved_s >= config_.training.checkpoint_every_s) {
        save();
        saved_s = clock.now_s();
      }
    }
    if (result_.best_env_steps == 0) text = note(evaluate());  // resumed at its very end
    progress.finish(text);
    save();
    result_.env_steps = learner_.env_steps();
    result_.updates = learner_.updates();
    result_.seconds_to_95_percent = seconds_to_fraction(0.95);
    result_.peak_memory_mb = common::peak_memory_mb();
    return result_;
  }

 private:
  PolicyScore evaluate() {
    const PolicyScore score = evaluation_.run(learner_.td3().actor());
    common::Scalars scalars = learner_.take_statistics();
    for (const auto& [key, value] : score.scalars()) scalars.emplace_back(key, value);
    scalars.emplace_back("train/updates", static_cast<double>(learner_.updates()));
    if (result_.train_seconds > 0.0) {
      scalars.emplace_back("train/steps_per_s",
                           static_cast<double>(learner_.env_steps()) / result_.train_seconds);
    }
    log_.write(learner_.env_steps(), scalars);
    returns_.emplace_back(result_.train_seconds, score.episode_return);
    if (learner_.env_steps() == 0) return score;
    if (result_.best_env_steps == 0 || score.episode_return > result_.evaluation.episode_return) {
      result_.evaluation = score;
      result_.best_env_steps = learner_.env_steps();
      save_best();
    }
    return score;
  }

  double seconds_to_fraction(double fraction) const {
    const double first = returns_.front().second;
    const double wanted = first + fraction * (returns_.back().second - first);
    const auto reached = std::find_if(returns_.begin() + 1, returns_.end() - 1,
                                      [wanted](const auto& entry) { return entry.second >= wanted; });
    return reached->first;
  }

  void save_best() {
    inference::Policy policy;
    policy.weights = nets::to_arrays(learner_.td3().actor_weights());
    policy.hidden = config_.td3.hidden;
    policy.encoder = config_.encoder;
    policy.action = config_.action;
    policy.rig = config_.learned_rig;
    policy.goal = config_.task.goal;
    policy.region = region_;
    common::Json metrics = score_to_json(result_.evaluation);
    metrics["env_steps"] = result_.best_env_steps;
    inference::save_policy(folder_ + "/checkpoint", policy, common::config_to_json(config_), metrics);
  }

  void save() {
    nets::Checkpoint checkpoint;
    checkpoint.kind = kKind;
    checkpoint.config = reproducibility_settings(config_);
    learner_.save(checkpoint);
    checkpoint.facts["run"] = {{"next_evaluation", next_evaluation_},
                               {"train_seconds", result_.train_seconds},
                               {"best_env_steps", result_.best_env_steps},
                               {"returns", returns_},
                               {"best", score_to_json(result_.evaluation)}};
    nets::save_checkpoint(folder_ + "/training", checkpoint);
  }

  [[noreturn]] void stop() {
    if (result_.best_env_steps == 0) evaluate();  // so that there is a policy to look at
    save();
    throw common::Interrupted("train-policy: stopped after " + std::to_string(learner_.env_steps()) +
                              " environment steps; run the same command with --resume to go on in " +
                              folder_);
  }

  TrainPolicyConfig config_;
  std::string folder_;
  PolicyEvaluation evaluation_;
  PolicyLearner learner_;
  common::MetricsLog log_;
  std::int64_t next_evaluation_;
  std::vector<std::pair<double, double>> returns_;  // of every evaluation: training time in s, mean return
  PolicyRunResult result_;
  std::optional<task::Region> region_;
};

}  // namespace

void TrainPolicyConfig::validate() const {
  const LearningConfig& learning = training.learning;
  if (learning.warm_up_steps >= learning.env_steps) {
    throw common::ConfigError("training.warm_up_steps = " + std::to_string(learning.warm_up_steps) +
                              " must be below training.env_steps = " + std::to_string(learning.env_steps));
  }
  if (replay.environments > training.environments) {
    throw common::ConfigError(
        "replay.environments = " + std::to_string(replay.environments) +
        " must not exceed training.environments = " + std::to_string(training.environments));
  }
  if (replay.environments > 0 && recorded.empty()) {
    throw common::ConfigError("replay.environments = " + std::to_string(replay.environments) +
                              " needs a recording: --set recorded=FILE.h5");
  }
  replay.validate();
  if (learning.hindsight > 0.0) Hindsight::check(task, encoder);
  if (td3.batch_size > learning.buffer_size) {
    throw common::ConfigError("training.buffer_size = " + std::to_string(learning.buffer_size) +
                              " must be at least td3.batch_size = " + std::to_string(td3.batch_size));
  }
}

TrainPolicyConfig adopt_rig(TrainPolicyConfig config) {
  config.action.scale = config.rig.coils.max_current_A;
  config.task.dish_radius_m = config.rig.dish.radius_m;
  config.encoder.length_scale_m = config.rig.dish.radius_m;
  config.learned_rig = common::config_to_json(config.rig);
  return config;
}

TrainPolicyConfig adopt_data(TrainPolicyConfig config, const data::DatasetInfo& info) {
  config.action.scale = info.action_scale;
  config.action.unit = info.action_unit;
  config.action.one_axis_at_a_time = info.one_axis_at_a_time;
  config.task.dish_radius_m = info.workspace_radius_m;
  config.encoder.length_scale_m = info.workspace_radius_m;
  config.learned_rig = info.rig;
  if (info.layout != data::StateLayout::kPose) config.encoder.heading = "none";
  return config;
}

common::Json PolicyRunResult::json() const {
  return {{"env_steps", env_steps},
          {"updates", updates},
          {"train_seconds", train_seconds},
          {"best_env_steps", best_env_steps},
          {"seconds_to_95_percent", seconds_to_95_percent},
          {"peak_memory_mb", peak_memory_mb},
          {"evaluation", evaluation.json()}};
}

PolicyRunResult train_policy(const TrainPolicyConfig& config, env::VecEnv& training, env::VecEnv& evaluation,
                             const std::string& folder, bool resume, const task::Region* region) {
  Run run(config, training, evaluation, folder, region);
  if (resume && std::filesystem::exists(folder + "/training")) run.resume();
  return run.train();
}

}  // namespace lodestone::rl
