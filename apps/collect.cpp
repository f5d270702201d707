#include <cstdio>
#include <memory>
#include <string>

#include "common_options.h"
#include "lodestone/common/files.h"
#include "lodestone/common/log.h"
#include "lodestone/control/decorators.h"
#include "lodestone/control/policy_controller.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/experiments/collection_run.h"
#include "lodestone/experiments/heading_need.h"
#include "lodestone/experiments/seeking.h"
#include "lodestone/nets/blas.h"
#include "models.h"
#include "teleoperation_window.h"
#include "terminal.h"
#include "verbs.h"

namespace lodestone::apps {

namespace {

struct CollectConfig {
  experiments::CollectionConfig collection;
  std::int64_t threads = 0;
  std::string by = "explorer";
  std::string policy;
  experiments::McapConfig mcap;
  control::GoalSeekerConfig seek;
  control::DecoratorConfig decorators;

  /// Whether a stretch that was lost can be driven again exactly as it was.
  bool repeatable() const { return !by_hand() && !collection.rig.real(); }
  bool by_hand() const { return by == "keyboard" || by == "gamepad"; }
  template <class Visitor>
  void visit(Visitor& v) {
    collection.visit(v);
    v.field("threads", threads, "", "sessions explored at the same time; 0 means one per processor",
            {0, 1024});
    v.field("by", by, "",
            "who drives: the guided explorer, a policy that goes from target to target, or you, at the "
            "keyboard or a "
            "gamepad",
            {"explorer", "policy", "keyboard", "gamepad"});
    v.field("policy", policy, "", "folder of the policy checkpoint that drives, with by = policy");
    v.group("mcap", mcap, "a log of each session");
    v.group("seek", seek, "how a policy explores");
    v.group("decorators", decorators, "what is put around that policy");
  }
  void validate() const {
    if (by == "policy" && policy.empty())
      throw common::ConfigError("by = policy: --policy DIR is missing; name a policy checkpoint");
    if (!repeatable() && collection.sessions != 1)
      throw common::ConfigError(
          "sessions = " + std::to_string(collection.sessions) +
          ": a real bench, or a human at the controls, has one at a time; set sessions = 1");
  }
};

using experiments::Sessions;

/// The policy that was trained on the first round drives the second one.
experiments::Teleoperator policy_teleoperator(const CollectConfig& config, std::int64_t session) {
  const inference::Policy policy = inference::load_policy(config.policy);
  experiments::refuse_heading(config.collection.rig, policy, config.policy);
  if (policy.goal != "point")
    throw common::ConfigError(config.policy + " was trained for goal \"" + policy.goal +
                              "\"; exploring needs a policy for points");
  const physics::RigDescription& rig = config.collection.rig;
  if (policy.action.size != rig.drive_size())
    throw common::ConfigError(config.policy + ": its actions are of " + std::to_string(policy.action.size) +
                              " numbers, the rig's drive is of " + std::to_string(rig.drive_size()) +
                              "; the policy was trained for another rig");
  if (policy.action.scale != config.collection.rig.coils.max_current_A)
    throw common::ConfigError(config.policy + ": its largest drive is " +
                              std::to_string(policy.action.scale) + ", the rig's is " +
                              std::to_string(config.collection.rig.coils.max_current_A) +
                              " A; the policy was trained for another rig");
  if (policy.encoder.drive_gain)
    common::log_warning(
        config.policy +
        " wants to know how strongly its rig answers; nothing identifies it while collecting");
  return experiments::goal_seeking(config.collection,
                                   control::decorate(std::make_unique<control::PolicyController>(policy),
                                                     config.decorators, physics::CoilDrive(rig)),
                                   config.seek, session);
}

/// A single session with somebody at the controls, or on a real bench.
std::unique_ptr<experiments::Collection> make_live_session(const CollectConfig& config,
                                                           const std::string& out,
                                                           std::unique_ptr<TeleoperationWindow>& window) {
  const experiments::CollectionConfig& collection = config.collection;
  if (collection.rig.real() && !collection.explorer.self_reset && !has_operator())
    throw common::HardwareError(
        "collect: every episode begins where somebody has placed the needle, and nobody can be asked here: "
        "run it in a terminal at the bench, set explorer.self_reset=true, try it with rig.backend=virtual, "
        "or "
        "record in your own way and use `lodestone import`");
  if (config.by_hand()) window = std::make_unique<TeleoperationWindow>(config.by, collection.rig);
  std::unique_ptr<session::RigSession> bench =
      collection.rig.real()
          ? session::make_bench_session(collection.rig, collection.sensor, collection.safety,
                                        terminal_operator(collection.rig), out)
          : experiments::make_exploration_session(collection, 0, true);
  std::optional<experiments::Teleoperator> teleoperator;
  if (window) teleoperator = window->teleoperator(*bench);
  if (config.by == "policy") teleoperator = policy_teleoperator(config, 0);
  return std::make_unique<experiments::Collection>(collection, std::move(bench), std::move(teleoperator));
}

Sessions make_sessions(const CollectConfig& collect, const std::string& out,
                       std::unique_ptr<TeleoperationWindow>& window) {
  Sessions sessions;
  if (!collect.repeatable()) {
    sessions.push_back(make_live_session(collect, out, window));
    return sessions;
  }
  const experiments::CollectionConfig& config = collect.collection;
  for (std::int64_t session = 0; session < config.sessions; ++session) {
    std::optional<experiments::Teleoperator> teleoperator;
    if (collect.by == "policy") teleoperator = policy_teleoperator(collect, session);
    sessions.push_back(std::make_unique<experiments::Collection>(
        config, experiments::make_exploration_session(config, session), std::move(teleoperator), session));
  }
  return sessions;
}

/// Every start of a run has logs of its own.
void log_sessions(const Sessions& sessions, const experiments::McapConfig& config, runs::RunFolder& run) {
  run.begin();
  common::make_folders(run.file("logs"));
  for (std::size_t session = 0; session < sessions.size(); ++session)
    sessions[session]->log_into(experiments::fresh_log(run.file("logs/session-" + std::to_string(session))),
                                config);
}

void print_recording(const runs::RunFolder& run, const runs::CollectionFacts& facts,
                     const data::Coverage& coverage) {
  std::printf("%lld transitions in %lld episodes: %s\n", static_cast<long long>(facts.transitions),
              static_cast<long long>(*facts.episodes), run.file(data::kRecordingFile).c_str());
  std::printf("placements by the operator: %lld, %.1f per 1,000 transitions\n",
              static_cast<long long>(*facts.placements), *facts.placements_per_1000);
  std::printf(
      "coverage: %lld of %lld cells of position, heading and drive visited (%.1f %%), evenness %.3f\n",
      static_cast<long long>(coverage.visited), static_cast<long long>(coverage.cells),
      100.0 * coverage.fraction, coverage.evenness);
}

void collect(const CommonOptions& options) {
  auto config = resolve_config<CollectConfig>(options);
  nets::use_one_blas_thread();
  choose_segmenter(config.collection.sensor);
  runs::RunRequest request{options.out, "collect", common::config_to_json(config), config.collection.seed,
                           options.resume};
  request.free_keys = experiments::free_mcap_keys();
  request.free_keys.insert(request.free_keys.end(), {"threads", "checkpoint_every_s", "rig.serial.port"});
  request.inputs = runs::named_inputs(request.config, {"policy", "sensor.segmenter"});
  runs::RunFolder run(request);
  if (run.finished()) {
    common::log_info("collect: " + run.path() + " is finished already");
  } else {
    std::unique_ptr<TeleoperationWindow> window;
    const Sessions sessions = make_sessions(config, run.path(), window);
    if (config.mcap.enabled) log_sessions(sessions, config.mcap, run);
    experiments::CollectionRun work(config.collection, sessions, config.repeatable(), config.threads,
                                    run.path());
    runs::run_resumably(
        run, work,
        {"collect", "transitions", config.repeatable() ? config.collection.checkpoint_every_s : 0.0});
    for (const auto& session : sessions) session->finish_log();
  }
  const auto [facts, coverage] = experiments::summarise_recording(run);
  if (!run.finished()) run.finish();
  print_recording(run, facts, coverage);
}

}  // namespace

void add_collect(Verb& program) {
  Verb& verb = program.add_verb("collect", "explore a rig and record its transitions (phase 1)");
  auto& options = configure<CollectConfig>(verb, collect);
  add_common_options(verb, options, /*with_resume=*/true);
  add_virtual_rig_options(verb, options);
  add_shorthand(verb, options, "--sensor", "sensor.kind", Shorthand::kText, "camera or simulated");
  add_shorthand(verb, options, "--by", "by", Shorthand::kText, "explorer, policy, keyboard or gamepad");
  add_shorthand(verb, options, "--policy", "policy", Shorthand::kText,
                "folder of the policy checkpoint for --by policy");
  add_mcap_option(verb, options, "a log of each session in the run's `logs`, which Foxglove opens");
}

}  // namespace lodestone::apps
