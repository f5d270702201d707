#include "lodestone/experiments/paper_plan.h"

#include <algorithm>
#include <utility>

#include "lodestone/common/random.h"

namespace lodestone::experiments {
namespace {

using Settings = std::vector<std::string>;

std::string set(const std::string& key, std::int64_t value) { return key + "=" + std::to_string(value); }

Settings joined(Settings a, const Settings& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// What an ablation changes in the best preset.
struct Ablation {
  std::string name;
  Settings dynamics;  ///< of train-dynamics; empty: the best preset's own dynamics are used
  Settings policy;    ///< of train-policy
};

class Builder {
 public:
  explicit Builder(const PaperScale& scale) : scale_(scale) {
    plan_.seed = scale.seed;
    plan_.subfolder = "cells";
    plan_.keep_checkpoints = false;  // hundreds of replay buffers would fill a disk
  }

  runs::Plan take() {
    add_data();
    for (std::int64_t s = 1; s <= scale_.seeds; ++s) add_tables(s);
    for (std::int64_t s = 1; s <= scale_.seeds; ++s) add_mixes(s);
    for (std::int64_t s = 1; s <= scale_.ablation_seeds; ++s) {
      for (const Ablation& ablation : ablations()) add_ablation(ablation, s);
    }
    return std::move(plan_);
  }

 private:
  runs::Cell& add(const std::string& id, const std::string& verb, const std::string& config,
                  Settings settings) {
    runs::Cell cell;
    cell.id = id;
    cell.verb = verb;
    cell.config = config;
    cell.settings = std::move(settings);
    cell.seed = seed_of(id);
    plan_.cells.push_back(std::move(cell));
    return plan_.cells.back();
  }

  /// Doubles hold integers up to 2^53, and so does JSON everywhere.
  std::int64_t seed_of(const std::string& name) const {
    return static_cast<std::int64_t>(common::derive_seed(static_cast<std::uint64_t>(scale_.seed), name) >>
                                     12);
  }

  static std::string with_seed(const std::string& name, std::int64_t s) {
    return name + "/" + std::to_string(s);
  }

  Settings steps(std::int64_t count) const {
    return {set("training.env_steps", count),
            set("training.buffer_size", std::min<std::int64_t>(count, 1000000)),
            set("training.warm_up_steps", count / 20),
            set("training.evaluate_every", std::max<std::int64_t>(count / 20, 1))};
  }

  /// The explorer's recording, a first policy made from it, and what that policy records.
  void add_data() {
    add("data/explorer", "collect", "paper/collect.json",
        {set("transitions", scale_.transitions), "sessions=2"})
        .all_threads = true;
    add("first/dynamics", "train-dynamics", "best/dynamics.json",
        {"data={data/explorer}/transitions.h5", set("training.epochs", scale_.best_epochs)})
        .all_threads = true;
    add("first/policy", "train-policy", "best/policy_target.json",
        joined({"dynamics={first/dynamics}/checkpoint"}, steps(scale_.ablation_steps)))
        .all_threads = true;
    add("data/policy", "collect", "best/collect.json",
        {"policy={first/policy}/checkpoint", set("transitions", scale_.second_transitions), "sessions=2"})
        .all_threads = true;
  }

  void add_policy(const std::string& id, const std::string& config, const Settings& settings,
                  std::int64_t count) {
    add(id, "train-policy", config, joined(settings, steps(count)));
  }

  /// Errors on unseen rigs: the same trials for every row.
  void add_transfer(const std::string& row, const std::string& task, std::int64_t s,
                    const std::string& config, Settings settings, const std::string& table = "transfer") {
    const bool ablation = table != "transfer";
    settings.push_back("task=" + task);
    settings.push_back(set("trials.count", ablation ? scale_.ablation_trials : scale_.trials));
    runs::Cell& cell =
        add(with_seed(table + "/" + row + "/" + task, s), "deploy", config, std::move(settings));
    cell.seed = seed_of(with_seed("evaluation/" + task, s));
  }

  /// Rows of tables I and II and figures 4 and 6 for one training seed.
  void add_tables(std::int64_t s) {
    const std::string paper = with_seed("dynamics/paper", s);
    const std::string best = with_seed("dynamics/best", s);
    add(paper, "train-dynamics", "paper/dynamics.json",
        {"data={data/explorer}/transitions.h5", set("training.epochs", scale_.paper_epochs)});
    add(best, "train-dynamics", "best/dynamics.json",
        {"data={data/explorer}/transitions.h5,{data/policy}/transitions.h5",
         set("training.epochs", scale_.best_epochs)});
    struct Row {
      std::string name, presets;
      Settings settings;
      std::int64_t centre_steps, target_steps;
      std::string deploy;
    };
    const std::vector<Row> rows = {
        {"simulator", "simulator", {}, scale_.simulator_steps, scale_.simulator_steps, "best/deploy.json"},
        {"randomised",
         "simulator",
         {"physics.randomise.enabled=true"},
         scale_.simulator_steps,
         scale_.simulator_steps,
         "best/deploy.json"},
        {"paper",
         "paper",
         {"dynamics={" + paper + "}/checkpoint"},
         scale_.paper_steps,
         scale_.paper_steps,
         "paper/deploy.json"},
        {"best",
         "best",
         {"dynamics={" + best + "}/checkpoint"},
         scale_.best_centre_steps,
         scale_.best_target_steps,
         "best/deploy.json"}};
    for (const Row& row : rows) {
      const std::string centre = with_seed("policy/" + row.name + "/centre", s);
      const std::string target = with_seed("policy/" + row.name + "/target", s);
      add_policy(centre, row.presets + "/policy_centre.json", row.settings, row.centre_steps);
      add_policy(target, row.presets + "/policy_target.json", row.settings, row.target_steps);
      const Settings alone = {"controller=policy", "on_rig=unseen"};
      add_transfer(row.name, "centre", s, row.deploy, joined({"policy={" + centre + "}/checkpoint"}, alone));
      for (const char* task : {"point", "square"})
        add_transfer(row.name, task, s, row.deploy, joined({"policy={" + target + "}/checkpoint"}, alone));
    }
    for (const char* task : {"centre", "point", "square"}) {
      add_transfer("planner", task, s, "best/deploy.json",
                   {"controller=planner", "on_rig=unseen", "dynamics={" + best + "}/checkpoint"});
      add_transfer("baseline", task, s, "best/deploy.json", {"controller=baseline", "on_rig=unseen"});
    }
    const std::string pose = with_seed("policy/best/pose", s);
    add_policy(pose, "best/policy_pose.json", {"dynamics={" + best + "}/checkpoint"},
               scale_.best_target_steps);
    add_transfer(
        "best", "pose", s, "best/deploy_pose.json",
        {"policy={" + pose + "}/checkpoint", "controller=policy", "on_rig=unseen", "turn.current_A=0"});
    const std::string target = with_seed("policy/best/target", s);
    add_transfer("turning", "pose", s, "best/deploy_pose.json",
                 {"policy={" + target + "}/checkpoint", "controller=policy", "on_rig=unseen"});
  }

  /// Figure 5: k of the paper's three environments play recorded steps; and learning from the recording
  /// alone.
  void add_mixes(std::int64_t s) {
    const std::string paper = with_seed("dynamics/paper", s);
    const Settings both = {"dynamics={" + paper + "}/checkpoint", "recorded={data/explorer}/transitions.h5"};
    for (std::int64_t k = 0; k <= 3; ++k) {
      add_policy(with_seed("mix/" + std::to_string(k), s), "paper/policy_centre.json",
                 joined(both, {set("replay.environments", k)}), scale_.mix_steps);
    }
    const std::string offline = with_seed("mix/offline", s);
    add_policy(offline, "best/policy_offline.json", both, scale_.ablation_steps);
    add_transfer("offline", "centre", s, "best/deploy.json",
                 {"policy={" + offline + "}/checkpoint", "controller=policy", "on_rig=unseen"});
  }

  /// Each changes one thing in the best preset.
  std::vector<Ablation> ablations() const {
    std::vector<Ablation> all = {
        {"best preset", {}, {}},
        {"without the second round of collection", {"data={data/explorer}/transitions.h5"}, {}},
        {"without a predicted distribution",
         {"model.components=0", "training.loss=huber", "training.huber_delta=0.03"},
         {"mbs.outcome=mean"}},
        {"mean of the distribution instead of samples", {}, {"mbs.outcome=mean"}},
        {"one network instead of four", {"model.members=1"}, {}},
        {"with batch normalisation in the dynamics", {"model.batch_norm=true"}, {}},
        {"theta instead of sine and cosine in the dynamics", {"model.form=paper"}, {}},
        {"theta instead of sine and cosine in the policy", {}, {"encoder.heading=angle"}},
        {"without memory of the last step", {}, {"encoder.memory=false"}},
        {"without hindsight", {}, {"training.hindsight=0"}},
        {"success radius 1 mm instead of 2", {}, {"task.success_radius_m=0.001"}},
        {"success radius 3 mm", {}, {"task.success_radius_m=0.003"}},
        {"success radius 5 mm", {}, {"task.success_radius_m=0.005"}},
        {"success radius shrinks from 3 to 1 mm",
         {},
         {"task.success_radius_m=0.003", "task.final_success_radius_m=0.001"}},
        {"holding still is part of the task",
         {},
         {"task.end_on_success=false", "task.beta=1", "task.current_cost=0.02", "action.dead_band=0.03"}},
        {"disagreement is penalised", {}, {"mbs.disagreement_penalty=2"}},
        {"episodes end at a disagreement of 4 mm", {}, {"mbs.disagreement_stop_m=0.004"}},
        {"starts and targets in the reachable region", {}, {"task.within=reachable"}},
        {"friction differs from episode to episode", {}, {"mbs.breakaway_scatter=0.2"}},
        {"Ornstein-Uhlenbeck noise instead of Gaussian", {}, {"noise.kind=ou"}},
    };
    for (const std::int64_t size : scale_.data_sizes) {
      all.push_back({std::to_string(size) + " transitions",
                     {"data={data/explorer}/transitions.h5", set("transitions", size)},
                     {}});
    }
    return all;
  }

  void add_ablation(const Ablation& ablation, std::int64_t s) {
    std::string name = ablation.name;
    std::replace(name.begin(), name.end(), ' ', '_');
    std::string dynamics = with_seed("dynamics/best", s);
    if (!ablation.dynamics.empty()) {
      dynamics = with_seed("ablation/" + name + "/dynamics", s);
      add(dynamics, "train-dynamics", "best/dynamics.json",
          joined({"data={data/explorer}/transitions.h5,{data/policy}/transitions.h5",
                  set("training.epochs", scale_.best_epochs)},
                 ablation.dynamics));
    }
    const std::string policy = with_seed("ablation/" + name + "/policy", s);
    add_policy(policy, "best/policy_target.json",
               joined({"dynamics={" + dynamics + "}/checkpoint"}, ablation.policy), scale_.ablation_steps);
    for (const char* task : {"point", "square"})
      add_transfer(name, task, s, "best/deploy.json",
                   {"policy={" + policy + "}/checkpoint", "controller=policy", "on_rig=unseen"}, "ablation");
  }

  PaperScale scale_;
  runs::Plan plan_;
};

}  // namespace

runs::Plan paper_plan(const PaperScale& scale) { return Builder(scale).take(); }

}  // namespace lodestone::experiments
