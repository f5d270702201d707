#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>

#include "common_options.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/exports/minari.h"
#include "lodestone/exports/policy_header.h"
#include "lodestone/exports/policy_onnx.h"
#include "lodestone/exports/policy_torchscript.h"
#include "lodestone/exports/run_log.h"
#include "lodestone/inference/policy.h"
#include "lodestone/nets/script_module.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

namespace fs = std::filesystem;

/// How a recording becomes episodes of a task (--data).
struct ExportConfig {
  std::int64_t seed = 1;
  std::int64_t threads = 0;
  std::string id;
  task::TaskConfig task = to_the_centre();

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("seed", seed, "", "seed of the goals of --data", {0, 9e15});
    v.field("threads", threads, "", "exporting uses one thread; taken so that every verb takes it",
            {0, 1024});
    v.field("id", id, "", "Minari's id of --data, [namespace/]name-v0; empty: lodestone/NAME-v0 of NAME.h5");
    v.group("task", task, "the task by which --data gets rewards and ends");
  }

 private:
  static task::TaskConfig to_the_centre() {
    task::TaskConfig task;
    task.goal = task::GoalKind::kCentre;
    return task;
  }
};

struct ExportOptions : CommonOptions {
  std::string policy;
  std::string run;
  std::string data;
  std::string to;
  bool force = false;
};

/// What can be exported, by the option that names it, and how: told by the ending of --to.
struct Format {
  const char* option;
  const std::string ExportOptions::*from;
  const char* ending;
  std::function<void(const ExportOptions&)> write;
};

void make_folder_of(const std::string& file) {
  const std::string folder = fs::path(file).parent_path().string();
  if (!folder.empty()) common::make_folders(folder);
}

void write_text(const std::string& file, const std::string& text) {
  make_folder_of(file);
  common::write_file_atomically(file, text);
}

void write_log(const ExportOptions& options) {
  make_folder_of(options.to);
  const exports::RunLogFacts facts = exports::write_run_log(options.run, options.to);
  const auto number = [](std::int64_t count) { return static_cast<long long>(count); };
  if (facts.episodes > 0)
    std::printf("episodes     %lld\nsteps        %lld\n", number(facts.episodes), number(facts.steps));
  else
    std::printf("trials       %lld\nsteps        %lld\nimages       %lld\n", number(facts.trials),
                number(facts.steps), number(facts.images));
}

using PolicyText = std::string (*)(const exports::PolicyContract&);

std::function<void(const ExportOptions&)> policy_as(PolicyText text) {
  return [text](const ExportOptions& options) {
    const exports::PolicyContract contract(inference::load_policy(options.policy), options.policy);
    write_text(options.to, text(contract));
  };
}

std::string policy_pt(const exports::PolicyContract& contract) {
  return nets::encode_script(exports::policy_torchscript(contract));
}

constexpr const char* kMinari = "minari:";

void write_as_minari(const ExportOptions& options) {
  const auto config = resolve_config<ExportConfig>(options);
  const data::Dataset dataset = data::read_recordings(options.data);
  exports::MinariSettings settings;
  settings.id = config.id.empty() ? exports::default_minari_id(options.data) : config.id;
  settings.task = config.task;
  settings.task.dish_radius_m = dataset.info.workspace_radius_m;
  settings.seed = static_cast<std::uint64_t>(config.seed);
  settings.replace = options.force;
  const std::string root = options.to.substr(std::string(kMinari).size());
  const exports::MinariSummary summary = exports::write_minari(root.empty() ? "." : root, dataset, settings);
  std::printf("dataset      %s, task %s\n", settings.id.c_str(), common::name_of(settings.task.goal).c_str());
  std::printf("episodes     %lld, %lld of them end at the goal\n", static_cast<long long>(summary.episodes),
              static_cast<long long>(summary.reached));
  std::printf("steps        %lld\n", static_cast<long long>(summary.steps));
  std::printf("size         %lld bytes, %.2f times the numbers alone\n",
              static_cast<long long>(summary.bytes),
              static_cast<double>(summary.bytes) / static_cast<double>(summary.raw_bytes));
}

const std::vector<Format>& formats() {
  static const std::vector<Format> all = {
      {"--policy", &ExportOptions::policy, ".onnx", policy_as(exports::policy_onnx)},
      {"--policy", &ExportOptions::policy, ".h", policy_as(exports::policy_header)},
      {"--policy", &ExportOptions::policy, ".pt", policy_as(policy_pt)},
      {"--run", &ExportOptions::run, ".mcap", write_log},
      {"--data", &ExportOptions::data, kMinari, write_as_minari},
  };
  return all;
}

/// Whether a file's name has the ending; one without a dot is a name itself, and one with a colon stands
/// before a folder.
bool ends_with(const fs::path& file, const std::string& ending) {
  if (ending.back() == ':') return file.string().rfind(ending, 0) == 0;
  return (ending.front() == '.' ? file.extension() : file.filename()) == ending;
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

const Format& chosen(const ExportOptions& options) {
  std::vector<std::string> known, given, endings;
  for (const Format& format : formats()) {
    if (known.empty() || known.back() != format.option) {
      known.emplace_back(format.option);
      if (!(options.*format.from).empty()) given.emplace_back(format.option);
    }
  }
  if (given.size() != 1)
    throw common::ConfigError("export takes one of " + listed(known) +
                              (given.empty() ? "" : ", not " + listed(given)) + ": what is to be exported");
  for (const Format& format : formats()) {
    if (given.front() != format.option) continue;
    if (ends_with(options.to, format.ending)) return format;
    endings.emplace_back(format.ending);
  }
  throw common::ConfigError("--to " + options.to + ": its ending does not say what to write; " +
                            given.front() + " becomes " + listed(endings));
}

/// A policy, a run and a recording say themselves what rig they are of; only goals are chosen here.
void refuse_what_is_not_used(const ExportOptions& options, const Format& format) {
  if (!options.rig_file.empty())
    throw common::ConfigError("export takes no --rig: what is exported says what rig it is of; leave it out");
  const bool goals = format.from == &ExportOptions::data;
  const std::string unused = goals || options.overrides.empty() ? "" : options.overrides.front().option;
  if (!unused.empty() || (!goals && !options.config_files.empty()))
    throw common::ConfigError((unused.empty() ? "--config" : unused) + " is of --data: of " + format.option +
                              " all is exported as it is; leave it out");
}

void run_export(const ExportOptions& options) {
  if (!options.out.empty()) throw common::ConfigError("export writes to --to, not to --out");
  const Format& format = chosen(options);
  refuse_what_is_not_used(options, format);
  if (fs::exists(options.to) && !options.force)
    throw common::ConfigError("--to " + options.to + " exists already: name a new file, or give --force");
  format.write(options);
  std::printf("written to   %s\n", options.to.c_str());
}

}  // namespace

void add_export(Verb& program) {
  Verb& verb =
      program.add_verb("export", "write a policy, a recording or a run as files that other programs read");
  auto& options = configure<ExportConfig>(verb, run_export);
  verb.add_option("--policy", &options.policy, "folder of a policy checkpoint or a released policy")
      .named("DIR");
  verb.add_option("--data", &options.data, "transitions: .h5, or .csv of recorded pulses").named("FILE");
  verb.add_option("--run", &options.run, "folder of a run of deploy or collect").named("DIR");
  verb.add_option(
          "--to", &options.to,
          "what to write; its ending says how: .onnx, .h (C99), .pt (TorchScript), .mcap, or minari:DIR "
          "(datasets of Minari lie in DIR)")
      .named("FILE")
      .required();
  add_shorthand(verb, options, "--task", "task.goal", Shorthand::kText,
                "of --data: centre (default), point or pose; task keys are set as elsewhere");
  add_shorthand(verb, options, "--id", "id", Shorthand::kText, "of --data: [namespace/]name-v0");
  verb.add_option("--force", &options.force, "replace --to when it exists");
  add_common_options(verb, options);
}

}  // namespace lodestone::apps
