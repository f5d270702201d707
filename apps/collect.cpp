#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "bench_session.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/progress.h"
#include "lodestone/common/run_folder.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/control/decorators.h"
#include "lodestone/control/goal_seeker.h"
#include "lodestone/control/policy_controller.h"
#include "lodestone/data/coverage.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/experiments/collection.h"
#include "lodestone/nets/blas.h"
#include "models.h"
#include "teleoperation_window.h"
#include "verb.h"

namespace lodestone::apps {

namespace {

struct CollectConfig {
  experiments::CollectionConfig collection;
  std::int64_t threads = 0;
  std::string by = "explorer";
  std::string policy;
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
    v.group("seek", seek, "how a policy explores");
    v.group("decorators", decorators, "what is put around that policy");
  }
  void validate() const {
    collection.rig.validate();
    if (by == "policy" && policy.empty())
      throw common::ConfigError("by = policy: --policy DIR is missing; name a policy checkpoint");
    if (!repeatable() && collection.sessions != 1)
      throw common::ConfigError("sessions = " + std::to_string(collection.sessions) +
                                ": a real bench, or a human at the controls, has one at a time");
  }
};

/// All sessions explore so many episodes, then their records are written, then the next round begins.
constexpr std::int64_t kEpisodesPerRound = 4;
/// Between two writes of the state this many rounds may have to be explored again by --resume.
constexpr std::int64_t kRoundsPerState = 10;

using Sessions = std::vector<std::unique_ptr<experiments::Collection>>;

/// The policy that was trained on the first round drives the second one.
experiments::Teleoperator policy_teleoperator(const CollectConfig& config, std::int64_t session) {
  const inference::Policy policy = inference::load_policy(config.policy);
  if (policy.goal != "point")
    throw common::ConfigError(config.policy + " was trained for goal \"" + policy.goal +
                              "\"; exploring needs a policy for points");
  if (policy.action.scale != config.collection.rig.coils.max_current_A)
    throw common::ConfigError(config.policy + ": its largest drive is " +
                              std::to_string(policy.action.scale) + ", the rig's is " +
                              std::to_string(config.collection.rig.coils.max_current_A) +
                              " A; the policy was trained for another rig");
  const auto seeker = std::make_shared<control::GoalSeeker>(
      control::decorate(std::make_unique<control::PolicyController>(policy), config.decorators), config.seek,
      config.collection.rig.dish.radius_m,
      common::RandomStream(static_cast<std::uint64_t>(config.collection.seed), "collect/targets",
                           static_cast<std::uint64_t>(session)));
  experiments::Teleoperator teleoperator;
  teleoperator.controller = seeker.get();
  teleoperator.episode_over = [seeker] { return false; };
  teleoperator.save = [seeker] { return seeker->save(); };
  teleoperator.restore = [seeker](const std::string& state) { seeker->restore(state); };
  return teleoperator;
}

/// A single session with somebody at the controls, or on a real bench.
std::unique_ptr<experiments::Collection> make_live_session(const CollectConfig& config,
                                                           const std::string& out,
                                                           std::unique_ptr<TeleoperationWindow>& window) {
  const experiments::CollectionConfig& collection = config.collection;
  if (config.by_hand())
    window = std::make_unique<TeleoperationWindow>(config.by, collection.rig.coils.max_current_A,
                                                   collection.rig.dish.radius_m);
  std::unique_ptr<session::RigSession> bench =
      collection.rig.real() ? open_bench(collection.rig, collection.sensor, collection.safety, out)
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

/// Episodes of one round, in the order of the sessions.
std::vector<data::Episode> explore(const Sessions& sessions, std::int64_t episode_steps,
                                   std::int64_t episodes_per_round, common::ThreadPool& pool) {
  std::vector<std::vector<data::Episode>> found(sessions.size());
  pool.for_each(sessions.size(), [&](std::size_t session) {
    for (std::int64_t i = 0; i < episodes_per_round; ++i)
      found[session].push_back(sessions[session]->next_episode(episode_steps));
  });
  std::vector<data::Episode> episodes;
  for (std::vector<data::Episode>& of_session : found)
    for (data::Episode& episode : of_session) episodes.push_back(std::move(episode));
  return episodes;
}

/// The part of a configuration that decides the data.
common::Json reproducibility_settings(CollectConfig config) {
  config.threads = 0;
  return common::config_to_json(config);
}

void write_state(const std::string& file, const Sessions& sessions, std::int64_t episodes,
                 std::int64_t transitions) {
  common::Json state = {{"episodes", episodes}, {"transitions", transitions}};
  state["sessions"] = common::Json::array();
  for (const auto& session : sessions) state["sessions"].push_back(session->save());
  common::write_file_atomically(file, state.dump());
}

void check_same_run(const std::string& folder, const CollectConfig& config) {
  const common::Json stored = common::read_json_file(folder + "/config.json");
  if (reproducibility_settings(common::config_from_json<CollectConfig>(stored, folder + "/config.json")) !=
      reproducibility_settings(config))
    throw common::ConfigError("--resume: the configuration differs from " + folder +
                              "/config.json; use the same --config and --set as before, or another --out");
}

/// Writes coverage.json and says what was recorded.
void report(const std::string& folder, const std::string& dataset_file) {
  const data::Dataset dataset = data::read_dataset(dataset_file);
  const data::Coverage coverage = data::measure_coverage(dataset);
  common::write_file_atomically(folder + "/coverage.json", data::coverage_to_json(coverage).dump(1) + "\n");
  std::printf("%lld transitions in %lld episodes: %s\n", static_cast<long long>(dataset.transitions()),
              static_cast<long long>(dataset.episodes.size()), dataset_file.c_str());
  std::printf(
      "coverage: %lld of %lld cells of position, heading and drive visited (%.1f %%), evenness %.3f\n",
      static_cast<long long>(coverage.visited), static_cast<long long>(coverage.cells),
      100.0 * coverage.fraction, coverage.evenness);
}

void collect(const CommonOptions& options) {
  auto config = resolve_config<CollectConfig>(options);
  if (options.out.empty())
    throw common::ConfigError("collect: --out DIR is missing; name the folder to write into");
  nets::use_one_blas_thread();
  choose_segmenter(config.collection.sensor);
  const std::int64_t total = config.collection.transitions;
  const std::string dataset_file = options.out + "/transitions.h5";
  const std::string state_file = options.out + "/state.json";
  const bool going_on = options.resume && std::filesystem::exists(state_file);
  if (options.resume && !going_on && std::filesystem::exists(dataset_file)) {
    check_same_run(options.out, config);
    common::log_info("collect: " + options.out + " is finished already");
    report(options.out, dataset_file);
    return;
  }
  std::unique_ptr<TeleoperationWindow> window;
  const Sessions sessions = make_sessions(config, options.out, window);
  std::int64_t episodes = 0;
  std::int64_t transitions = 0;
  if (going_on) {
    check_same_run(options.out, config);
    const common::Json state = common::read_json_file(state_file);
    for (std::size_t i = 0; i < sessions.size(); ++i) sessions[i]->restore(state.at("sessions").at(i));
    episodes = state.at("episodes").get<std::int64_t>();
    transitions = state.at("transitions").get<std::int64_t>();
  } else {
    common::start_run_folder(options.out, "collect", common::config_to_json(config), config.collection.seed,
                             false);
    write_state(state_file, sessions, 0, 0);
  }
  if (going_on && !config.repeatable() && std::filesystem::exists(dataset_file)) {
    // Nobody can drive it again: what is on disk counts.
    const data::Dataset saved = data::read_dataset(dataset_file);
    episodes = static_cast<std::int64_t>(saved.episodes.size());
    transitions = saved.transitions();
  }
  auto writer =
      std::make_unique<data::DatasetWriter>(dataset_file, experiments::dataset_info(config.collection),
                                            going_on && std::filesystem::exists(dataset_file));
  // The file may hold episodes that the state does not know yet: they are explored again, which gives the
  // same numbers, and not written twice.
  const std::int64_t stored = writer->episodes();
  if (stored < episodes)
    throw common::DataError(dataset_file + " holds " + std::to_string(stored) + " episodes, the state says " +
                            std::to_string(episodes) + "; start again in another folder");
  // What cannot be repeated is saved episode by episode.
  const std::int64_t per_round = config.repeatable() ? kEpisodesPerRound : 1;
  common::Progress progress("collect", total);
  try {
    common::ThreadPool pool(static_cast<std::size_t>(config.threads));
    for (std::int64_t round = 1; transitions < total; ++round) {
      for (data::Episode& episode : explore(sessions, config.collection.episode_steps, per_round, pool)) {
        if (transitions >= total) break;
        if (transitions + episode.length() > total) episode = data::first_steps(episode, total - transitions);
        if (episodes >= stored) writer->write(episode);
        ++episodes;
        transitions += episode.length();
      }
      if (round % kRoundsPerState == 0) write_state(state_file, sessions, episodes, transitions);
      progress.update(transitions, std::to_string(episodes) + " episodes");
    }
  } catch (const common::Interrupted&) {
    throw common::Interrupted("collect: stopped after " + std::to_string(transitions) + " of " +
                              std::to_string(total) +
                              " transitions; `--resume` with the same options goes on");
  }
  progress.finish();
  writer.reset();
  report(options.out, dataset_file);
  std::filesystem::remove(state_file);
}

}  // namespace

void add_collect(CLI::App& program, ConfigCatalogue& catalogue) {
  CLI::App* verb = program.add_subcommand("collect", "explore a rig and record its transitions (phase 1)");
  auto options = std::make_shared<CommonOptions>();
  catalogue["collect"] = [options] { return describe_resolved<CollectConfig>(*options); };
  add_common_options(*verb, *options, true);
  add_virtual_rig_options(*verb, *options);
  add_shorthand(*verb, *options, "--sensor", "sensor.kind", Shorthand::kText, "camera or simulated");
  add_shorthand(*verb, *options, "--by", "by", Shorthand::kText, "explorer, policy, keyboard or gamepad");
  add_shorthand(*verb, *options, "--policy", "policy", Shorthand::kText,
                "folder of the policy checkpoint for --by policy");
  verb->callback([options] { collect(*options); });
}

}  // namespace lodestone::apps
