#include "lodestone/console/console.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/build_facts.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/shell.h"
#include "lodestone/experiments/deployment_job.h"
#include "lodestone/experiments/emulated_rig.h"
#include "lodestone/experiments/routing.h"
#include "lodestone/nets/blas.h"
#include "models.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

/// Keys are those of deploy, so that its presets fit, and where the page is served.
struct ConsoleConfig : experiments::DeployConfig {
  std::string listen = "127.0.0.1";
  std::int64_t port = 8642;
  std::string runs = "runs";

  ConsoleConfig() {
    deployment.loop.rest_s = 0.2333;  // a period of a third of a second, with pulses that come evenly
    deployment.loop.decide_s = 0.12;
    deployment.turn.current_A = 1.5;  // a target that is dragged has a heading
    deployment.turn.max_current_A = 4.0;
    deployment.turn.lead_deg = 110.0;
  }
  template <class Visitor>
  void visit(Visitor& v) {
    DeployConfig::visit(v);
    v.field(
        "listen", listen, "",
        "address that the page is served on; beyond this machine's own only with a token that is printed");
    v.field("port", port, "", "TCP port of the page; 0: any that is free", {0, 65535});
    v.field("runs", runs, "", "folder whose runs the page lists");
  }
  void validate() const {
    DeployConfig::validate();
    if (deployment.sensor.kind != "camera")
      throw common::ConfigError("sensor.kind = \"" + deployment.sensor.kind +
                                "\": the console shows what a camera sees; use \"camera\"");
    if (deployment.trials.obstacles.count > 0)
      throw common::ConfigError(
          "trials.obstacles.count = " + std::to_string(deployment.trials.obstacles.count) +
          ": there are no trials here to draw obstacles for; stand some in the dish by "
          "rig.simulation.obstacles, or use deploy");
    if (mcap.enabled)
      throw common::ConfigError("mcap.enabled = true: the console records by itself; deploy --mcap logs");
  }
};

struct ConsoleOptions : CommonOptions {
  bool emulate = false;
  bool virtual_rig = false;
  bool no_open = false;
};

std::vector<experiments::ControllerSource> sources(const ConsoleConfig& config,
                                                   console::ConsoleParts& parts) {
  const experiments::DeploymentConfig& deployment = config.deployment;
  std::vector<experiments::ControllerSource> found;
  std::optional<experiments::SimulatorSource> simulator;
  if (!config.dynamics.empty()) simulator = experiments::load_simulator(deployment, config.dynamics);
  std::optional<inference::Policy> policy;
  if (!config.policy.empty()) policy = inference::load_policy(config.policy);
  if (simulator && policy) experiments::go_by_cost_to_go(deployment, *policy, config.policy, *simulator);
  const experiments::SimulatorSource* identified_by = simulator ? &*simulator : nullptr;
  if (simulator) found.push_back(experiments::planner_source(deployment, *simulator));
  if (policy) {
    parts.region = policy->region;
    found.push_back(experiments::policy_source(deployment, *policy, config.policy, identified_by));
  }
  parts.bench.routes = experiments::route_map(deployment, identified_by, policy ? &*policy : nullptr);
  found.push_back(experiments::baseline_source(deployment, identified_by));
  found.push_back(experiments::observer_source(deployment));
  return found;
}

/// A rig that can be connected, and how; again after it was gone.
struct Connected {
  rig::RigConfig rig;
  std::function<std::unique_ptr<session::RigSession>()> connect;
};

Connected emulated(const experiments::DeploymentConfig& config) {
  const auto made = std::make_shared<experiments::EmulatedRig>(
      experiments::make_emulated_rig(config.rig, static_cast<std::uint64_t>(config.rig_seed),
                                     &config.sensor.scene, static_cast<std::uint64_t>(config.sensor_seed)));
  return {made->description, [made, config] {
            return session::make_bench_session(
                made->description, config.sensor, config.safety,
                [made](const geometry::Pose2& pose) { made->bench->place(pose); });
          }};
}

Connected connected(const experiments::DeploymentConfig& config) {
  if (config.rig.real())
    return {config.rig, [config] {
              // Whoever places the needle is at the bench: its place is forgotten, and looked for.
              return session::make_bench_session(config.rig, config.sensor, config.safety,
                                                 [](const geometry::Pose2&) {});
            }};
  return {config.rig, [config] {
            session::VirtualSeeds seeds;
            seeds.rig = static_cast<std::uint64_t>(config.rig_seed);
            seeds.scene = static_cast<std::uint64_t>(config.sensor_seed);
            seeds.sensor_noise =
                common::RandomStream(static_cast<std::uint64_t>(config.seed), "sensor noise of the console");
            return session::make_virtual_session(config.rig, config.sensor, config.safety, seeds, true);
          }};
}

/// The rig as other runs of this program have it.
void write_job_config(const ConsoleConfig& config, const rig::RigConfig& rig, const std::string& file) {
  const experiments::DeploymentConfig& deployment = config.deployment;
  common::write_json(file, {{"rig", common::config_to_json(rig)},
                            {"safety", common::config_to_json(deployment.safety)},
                            {"sensor", common::config_to_json(deployment.sensor)}});
}

/// What can be started from the page. A rig that is there is let go of meanwhile; of a virtual one each has
/// its own.
std::vector<console::JobKind> jobs(const ConsoleConfig& config, const rig::RigConfig& rig, bool emulated,
                                   const std::string& file) {
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.begin(), own_path());
    words.insert(words.end(), {"--config", file, "--out", "{out}"});
    return words;
  };
  const bool real = rig.real();
  std::vector<console::JobKind> kinds = {
      {"collect",
       run({"collect", "--set", "transitions=1000", "--set", "explorer.self_reset=true"}),
       {},
       real}};
  if (!config.dynamics.empty())
    kinds.push_back({"adapt", run({"adapt", "--models", config.dynamics, "--pulses", "1000"}), {}, real});
  if (!real) return kinds;
  kinds.push_back({"calibrate", run({"calibrate"}), {}, true});
  session::RigCheckConfig check;
  check.rig = rig;
  check.safety = config.deployment.safety;
  check.safety.max_current_A = std::min(check.safety.max_current_A, rig.coils.max_current_A);
  check.sensor = config.deployment.sensor;
  check.safety.stop_file = file + ".stop";
  kinds.push_back({"rig check",
                   {},
                   [check](session::Dialogue& dialogue) { session::check_rig(check, {}, dialogue); },
                   true,
                   check.safety.stop_file,
                   !emulated});
  return kinds;
}

void open_in_browser(const std::string& url) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  const std::string command = "xdg-open " + common::shell_quoted(url) + " >/dev/null 2>&1 &";
  if (std::system(command.c_str()) != 0) common::log_info("no browser was found: open " + url + " in one");
}

void console(const ConsoleOptions& given) {
  ConsoleOptions options = given;
  if (options.virtual_rig || options.emulate)
    options.overrides.push_back({"rig.backend=virtual", options.emulate ? "--emulate" : "--virtual"});
  auto config = resolve_config<ConsoleConfig>(options);
  // The released models know opposed pairs; other drives have the baseline, unless they bring their own.
  const bool pairs = config.deployment.rig.drive.kind == physics::DriveKind::kOpposedPairs;
  if (config.policy.empty() && config.dynamics.empty() && pairs) {
    use_models(options, shipped_folder("models") + "/any_rig");
    config = resolve_config<ConsoleConfig>(options);
  }
  config.deployment = experiments::in_flow(config);
  nets::use_one_blas_thread();
  choose_segmenter(config.deployment.sensor);
  console::ConsoleParts parts;
  parts.bench.config = config.deployment;
  parts.bench.sources = sources(config, parts);
  parts.rig_kind = options.emulate ? "emulated" : common::name_of(config.deployment.rig.backend);
  parts.rig_name = options.rig_file.empty() ? parts.rig_kind + " rig" : options.rig_file;
  parts.runs = config.runs;
  parts.folder = options.out.empty() ? config.runs + "/console/" + common::utc_now() : options.out;
  Connected rig = options.emulate ? emulated(config.deployment) : connected(config.deployment);
  parts.bench.connect = rig.connect;
  const std::string job_file = parts.folder + "/job.json";
  parts.jobs = jobs(config, rig.rig, options.emulate, job_file);
  parts.address = config.listen == "localhost" ? "127.0.0.1" : config.listen;
  parts.port = static_cast<std::uint16_t>(config.port);
  const console::Console served(std::move(parts));
  write_job_config(config, rig.rig, job_file);
  std::printf("%s\n", served.url().c_str());
  std::fflush(stdout);
  if (!options.no_open) open_in_browser(served.url());
  common::log_info("the console is served there until Ctrl-C");
  common::SteadyClock clock;
  while (!common::interrupted()) clock.sleep_until(clock.now_s() + 0.1);
}

}  // namespace

void add_console(Verb& program) {
  Verb& verb = program.add_verb("console", "serve a page that shows the rig, drives it, and stops it");
  auto& options = configure<ConsoleConfig>(verb, console);
  add_common_options(verb, options);
  add_virtual_rig_options(verb, options);
  add_models_option(verb, options);
  verb.add_option("--virtual", &options.virtual_rig, "on a simulated rig, whatever rig.json says");
  verb.add_option("--emulate", &options.emulate,
                  "on an emulated bench: the real firmware, a GigE Vision camera");
  verb.add_option("--no-open", &options.no_open, "do not open the page in a browser");
  add_shorthand(verb, options, "--port", "port", Shorthand::kValue, "TCP port of the page");
  add_shorthand(verb, options, "--listen", "listen", Shorthand::kText,
                "address to serve on, such as 0.0.0.0; the page then needs the token that is printed");
}

}  // namespace lodestone::apps
