#include "lodestone/experiments/paper_plan.h"

#include <algorithm>
#include <optional>
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

std::string with_seed(const std::string& name, std::int64_t s) { return name + "/" + std::to_string(s); }

/// Of a change, in ids.
std::string folder_of(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

std::string checkpoint_of(const std::string& cell) { return "{" + cell + "}/checkpoint"; }

/// A policy of table II: how it is trained, for the centre and for points.
struct PolicyRow {
  std::string name;
  std::string presets;  ///< folder of policy_centre.json and policy_target.json
  Settings settings;
  bool learned_here;  ///< is one of ours, so that it is also driven with what identification knows

  std::string centre_config() const { return presets + "/policy_centre.json"; }
  std::string target_config() const { return presets + "/policy_target.json"; }
};

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

  /// Seed by seed, so that the tables are whole as early as possible.
  runs::Plan take() {
    add_recordings();
    for (std::int64_t s = 1; s <= std::max(scale_.seeds, scale_.ablation_seeds); ++s) {
      if (s <= scale_.seeds) add_seed(s);
      if (s > scale_.ablation_seeds) continue;
      for (const Ablation& ablation : ablations()) add_ablation(ablation, s);
    }
    return std::move(plan_);
  }

  /// Every policy of Tables I and II, for a while.
  runs::Plan take_paces() {
    add_recordings();
    const auto add_simulator = [this](const std::string& name) {
      add(name, "train-dynamics", name == "dynamics/paper" ? "paper/dynamics.json" : "best/dynamics.json",
          {"data={data/" + name.substr(name.find('/') + 1) + "}/transitions.h5", "training.epochs=1"});
    };
    add_simulator("dynamics/paper");
    add_simulator("dynamics/best");
    const auto add_pace = [this](const std::string& row, const std::string& task, const std::string& config,
                                 const Settings& settings, std::int64_t steps) {
      const std::int64_t evaluations = is_as_the_paper(config) ? kPacedEvaluations : kPacedEvaluationsOfOurs;
      add_policy("pace/" + row + "/" + task, config, settings, steps,
                 evaluations * steps_between_evaluations(steps));
    };
    for (const PolicyRow& row : rows("dynamics/paper", "dynamics/best")) {
      add_pace(row.name, "centre", row.centre_config(), row.settings, scale_.centre_steps);
      add_pace(row.name, "target", row.target_config(), row.settings, scale_.target_steps);
    }
    add_pace("any_rig", "target", kGradient, {"dynamics=" + checkpoint_of("dynamics/best")},
             scale_.target_steps);
    add_pace("offline", "centre", kOffline, mixed("dynamics/paper"), scale_.centre_steps);
    return std::move(plan_);
  }

 private:
  void add_recordings() {
    add("data/paper", "collect", "paper/collect.json", {set("transitions", scale_.transitions), "sessions=2"})
        .all_threads = true;
    add("data/best", "collect", "best/collect_explorer.json", {set("transitions", scale_.transitions)})
        .all_threads = true;
  }

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

  static bool is_as_the_paper(const std::string& config) { return config.rfind("paper/", 0) == 0; }

  static std::int64_t steps_between_evaluations(std::int64_t steps) {
    return std::max<std::int64_t>(steps / 50, 1);
  }

  /// A training of so many steps, and how many of them it does.
  void add_policy(const std::string& id, const std::string& config, Settings settings, std::int64_t steps,
                  std::optional<std::int64_t> done = std::nullopt) {
    settings.insert(settings.end(),
                    {set("training.env_steps", done.value_or(steps)),
                     set("training.buffer_size", std::min<std::int64_t>(steps, 1000000)),
                     set("training.warm_up_steps",
                         std::min<std::int64_t>(steps / 20, is_as_the_paper(config) ? 5000 : 20000)),
                     set("training.evaluate_every", steps_between_evaluations(steps))});
    if (config != kGradient)
      settings.emplace_back("td3.products=bfloat16");  // where the processor is faster so
    add(id, "train-policy", config, std::move(settings));
  }

  /// One task of one row on unseen rigs: the same trials for every row.
  void add_trials(const std::string& id, const std::string& task, std::int64_t s, const std::string& config,
                  Settings settings, std::int64_t count, std::int64_t drawn = 0) {
    settings.insert(settings.end(), {"on_rig=unseen", "task=" + task, set("trials.count", count)});
    runs::Cell& cell = add(with_seed(id + "/" + task, s), "deploy", config, std::move(settings));
    cell.seed = seed_of(with_seed("evaluation/" + task, s));
    cell.drawn_trials = s == 1 ? drawn : 0;
  }

  /// Bare, where the paper's TD3 trains, too: with the dead zones at the wall. Squares keep away from it.
  void add_whole_dish(const std::string& row, const std::string& task, std::int64_t s,
                      const Settings& driver) {
    if (task != "square")
      add_trials("transfer/" + row + "/whole_dish", task, s, kBare,
                 joined(driver, {"trials.start_radius=0.96", "trials.goal_radius=1"}), scale_.trials);
  }

  /// Bare and decorated; with an `identified_by`, both also with what is identified in that simulator.
  void add_transfer(const std::string& row, const std::string& task, std::int64_t s, const Settings& driver,
                    const std::string& identified_by = "") {
    const auto drive = [&](const std::string& variant, const std::string& config, const Settings& more) {
      add_trials("transfer/" + row + "/" + variant, task, s, config, joined(driver, more), scale_.trials,
                 kDrawnTrials);
    };
    const bool plans = driver.front() == "controller=planner";
    const Settings simulator =
        identified_by.empty() ? Settings{} : Settings{"dynamics=" + checkpoint_of(identified_by)};
    const Settings unknown = plans ? joined(simulator, {"identification.enabled=false"}) : Settings{};
    drive("bare", kBare, unknown);
    drive("decorated", kDecorated, unknown);
    if (identified_by.empty()) return;
    drive("identified", kBare, simulator);
    drive("identified_decorated", kDecorated, simulator);
  }

  void add_seed(std::int64_t s) {
    const std::string paper = with_seed("dynamics/paper", s);
    const std::string best = with_seed("dynamics/best", s);
    add(paper, "train-dynamics", "paper/dynamics.json",
        {"data={data/paper}/transitions.h5", set("training.epochs", scale_.paper_epochs)});
    add(best, "train-dynamics", "best/dynamics.json",
        {"data={data/best}/transitions.h5", set("training.epochs", scale_.best_epochs)});
    add_tables(s, paper, best);
    add_mixes(s, paper);
    add_open_choices(s, paper);
  }

  /// Policies of tables I and II that learn by trial, in simulators that these cells learn or in none of
  /// them.
  static std::vector<PolicyRow> rows(const std::string& paper, const std::string& best) {
    return {
        {"best", "best", {"dynamics=" + checkpoint_of(best)}, true},
        {"simulator", "simulator", {}, false},
        {"randomised", "simulator", {"physics.randomise.enabled=true"}, false},
        {"paper", "paper", {"dynamics=" + checkpoint_of(paper)}, false},  // by far the longest
        {"paper_simulator",
         "paper",
         {"simulator=physics", "task.start_radius=0.82"},
         false},  // clear of the wall
    };
  }

  /// Rows of tables I and II and figures 4 and 6 for one training seed.
  void add_tables(std::int64_t s, const std::string& paper, const std::string& best) {
    const std::string any_rig = with_seed("policy/any_rig/target", s);
    add_policy(any_rig, kGradient, {"dynamics=" + checkpoint_of(best)}, scale_.target_steps);
    for (const char* task : {"centre", "point", "square"}) {
      add_transfer("any_rig", task, s, {"controller=policy", "policy=" + checkpoint_of(any_rig)}, best);
      add_transfer("planner", task, s, {"controller=planner"}, best);
      add_transfer("baseline", task, s, {"controller=baseline"}, best);
      add_whole_dish("baseline", task, s, {"controller=baseline"});
    }
    for (const PolicyRow& row : rows(paper, best)) {
      const std::string centre = with_seed("policy/" + row.name + "/centre", s);
      const std::string target = with_seed("policy/" + row.name + "/target", s);
      add_policy(centre, row.centre_config(), row.settings, scale_.centre_steps);
      add_policy(target, row.target_config(), row.settings, scale_.target_steps);
      const std::string identified_by = row.learned_here ? best : "";
      for (const char* task : {"centre", "point", "square"}) {
        const std::string& policy = std::string(task) == "centre" ? centre : target;
        const Settings driver = {"controller=policy", "policy=" + checkpoint_of(policy)};
        add_transfer(row.name, task, s, driver, identified_by);
        if (is_as_the_paper(row.centre_config())) add_whole_dish(row.name, task, s, driver);
      }
    }
  }

  /// Figure 5: k of the paper's three environments play recorded steps; and learning from the recording
  /// alone.
  void add_mixes(std::int64_t s, const std::string& paper) {
    for (std::int64_t k = 0; k <= 3; ++k) add_mix("mix/" + std::to_string(k), s, paper, k, {});
    const std::string offline = with_seed("mix/offline", s);
    add_policy(offline, kOffline, mixed(paper), scale_.centre_steps);
    add_transfer("offline", "centre", s, {"controller=policy", "policy=" + checkpoint_of(offline)});
  }

  static Settings mixed(const std::string& paper) {
    return {"dynamics=" + checkpoint_of(paper), "recorded={data/paper}/transitions.h5"};
  }

  void add_mix(const std::string& id, std::int64_t s, const std::string& paper, std::int64_t replaying,
               const Settings& more) {
    add_policy(with_seed(id, s), "paper/policy_centre.json",
               joined(mixed(paper), joined({set("replay.environments", replaying)}, more)), scale_.mix_steps);
  }

  /// What the paper leaves open, decided otherwise.
  void add_open_choices(std::int64_t s, const std::string& paper) {
    const auto centre = [&](const std::string& name, const std::string& dynamics, Settings more) {
      const std::string policy = with_seed("open/" + folder_of(name) + "/policy", s);
      more.insert(more.begin(), "dynamics=" + checkpoint_of(dynamics));
      add_policy(policy, "paper/policy_centre.json", more, scale_.centre_steps);
      add_trials("open/" + folder_of(name), "centre", s, kBare,
                 {"controller=policy", "policy=" + checkpoint_of(policy)}, scale_.trials);
    };
    centre("reward in mm", paper, {"task.alpha=-425"});
    centre("reward in m", paper, {"task.alpha=-0.425"});
    const std::string cut = with_seed("open/ReLU_on_the_input/dynamics", s);
    add(cut, "train-dynamics", "paper/dynamics.json",
        {"data={data/paper}/transitions.h5", set("training.epochs", scale_.paper_epochs),
         "model.input_relu=true"});
    centre("ReLU on the input", cut, {});
    for (const std::int64_t k : {1, 3})
      add_mix("open/short_episodes_kept/mix/" + std::to_string(k), s, paper, k, {"replay.keep_shorter=true"});
  }

  /// Each changes one thing in the best preset.
  std::vector<Ablation> ablations() const {
    std::vector<Ablation> all = {
        {"best preset", {}, {}},
        {"a recording without weak pulses", {"data={data/paper}/transitions.h5"}, {}},
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
    for (const std::int64_t size : scale_.data_sizes)
      all.push_back({std::to_string(size) + " transitions", {set("transitions", size)}, {}});
    return all;
  }

  void add_ablation(const Ablation& ablation, std::int64_t s) {
    const std::string name = "ablation/" + folder_of(ablation.name);
    std::string dynamics = with_seed("dynamics/best", s);
    if (!ablation.dynamics.empty() || plan_.find(dynamics) == nullptr) {
      dynamics = with_seed(name + "/dynamics", s);
      add(dynamics, "train-dynamics", "best/dynamics.json",
          joined({"data={data/best}/transitions.h5", set("training.epochs", scale_.best_epochs)},
                 ablation.dynamics));
    }
    const std::string policy = with_seed(name + "/policy", s);
    add_policy(policy, "best/policy_target.json",
               joined({"dynamics=" + checkpoint_of(dynamics)}, ablation.policy), scale_.ablation_steps);
    for (const char* task : {"point", "square"})
      add_trials(name, task, s, kBare, {"controller=policy", "policy=" + checkpoint_of(policy)},
                 scale_.ablation_trials);
  }

  static constexpr std::int64_t kDrawnTrials = 8;  // of the first seed
  // The second half of them is timed, which warming up ends before; ours are quick.
  static constexpr std::int64_t kPacedEvaluations = 2, kPacedEvaluationsOfOurs = 10;
  static constexpr const char* kGradient = "best/policy_any_rig.json";
  static constexpr const char* kOffline = "best/policy_offline.json";
  static constexpr const char* kBare = "paper/deploy.json";
  static constexpr const char* kDecorated = "best/deploy.json";

  PaperScale scale_;
  runs::Plan plan_;
};

}  // namespace

runs::Plan paper_plan(const PaperScale& scale) { return Builder(scale).take(); }

runs::Plan paper_pace_plan(const PaperScale& scale) {
  constexpr std::int64_t kEnoughPulses = 2000;
  PaperScale small = scale;
  small.transitions = std::min(scale.transitions, kEnoughPulses);
  return Builder(small).take_paces();
}

}  // namespace lodestone::experiments
