#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
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

struct ExportOptions {
  std::string policy;
  std::string run;
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

const std::vector<Format>& formats() {
  static const std::vector<Format> all = {
      {"--policy", &ExportOptions::policy, ".onnx", policy_as(exports::policy_onnx)},
      {"--policy", &ExportOptions::policy, ".h", policy_as(exports::policy_header)},
      {"--policy", &ExportOptions::policy, ".pt", policy_as(policy_pt)},
      {"--run", &ExportOptions::run, ".mcap", write_log},
  };
  return all;
}

/// Whether a file's name has the ending; one without a dot is a name itself.
bool ends_with(const fs::path& file, const std::string& ending) {
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

void run_export(const ExportOptions& options) {
  const Format& format = chosen(options);
  if (fs::exists(options.to) && !options.force)
    throw common::ConfigError("--to " + options.to + " exists already: name a new file, or give --force");
  format.write(options);
  std::printf("written to   %s\n", options.to.c_str());
}

}  // namespace

void add_export(Verb& program) {
  Verb& verb =
      program.add_verb("export", "write a policy, or what a run recorded, as a file for other programs");
  const auto options = std::make_shared<ExportOptions>();
  verb.add_option("--policy", &options->policy, "folder of a policy checkpoint or a released policy")
      .named("DIR");
  verb.add_option("--run", &options->run, "folder of a run of deploy").named("DIR");
  verb.add_option("--to", &options->to,
                  "what to write; its ending says how: .onnx, .h (C99), .pt (TorchScript), .mcap")
      .named("FILE")
      .required();
  verb.add_option("--force", &options->force, "replace --to when it exists");
  verb.run = [options] { run_export(*options); };
}

}  // namespace lodestone::apps
