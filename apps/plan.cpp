#include <filesystem>
#include <memory>
#include <set>
#include <sstream>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/runs/engines.h"
#include "models.h"
#include "plan_folder.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

struct PlanOptions {
  std::string file;
  std::string out;
  std::optional<std::int64_t> seed;
  std::int64_t threads = 0;
  std::string only;
  std::string engine = "ninja";
  std::string rig_file;
};

/// What the results depend on: a cell that was given too little may be given more.
runs::Plan without_limits(runs::Plan plan) {
  plan.memory_mb.reset();
  plan.minutes.reset();
  for (runs::Cell& cell : plan.cells) {
    cell.memory_mb.reset();
    cell.minutes.reset();
  }
  return plan;
}

/// A key or value that a verb does not take is told before anything is run; once of what seeds share.
void check_settings(const runs::Plan& plan, const PlanOptions& options, const std::string& configs) {
  std::set<std::vector<std::string>> checked;
  for (const runs::Cell& cell : plan.cells) {
    std::vector<std::string> words;
    std::istringstream verb(cell.verb);
    for (std::string word; verb >> word;) words.push_back(word);
    if (!cell.config.empty())
      words.insert(words.end(), {"--config", (std::filesystem::path(configs) / cell.config).string()});
    if (!options.rig_file.empty()) words.insert(words.end(), {"--rig", options.rig_file});
    for (const std::string& setting : cell.settings) words.insert(words.end(), {"--set", setting});
    if (checked.insert(words).second)
      configuration_rows(words, options.file + ": cell \"" + cell.id + "\": ");
  }
}

void run_plan(const PlanOptions& options) {
  runs::Plan plan = runs::read_plan(options.file);
  plan.validate();
  check_settings(plan, options, shipped_folder("configs"));
  if (options.seed) plan.seed = *options.seed;
  const runs::PlanPlace place{options.out, own_path(), shipped_folder("configs"), options.rig_file,
                              common::thread_count(options.threads)};
  const std::unique_ptr<runs::Engine> engine = runs::make_engine(options.engine);
  runs::run_plan_in_folder(plan, place, *engine, "plan run", common::artefact_to_json(without_limits(plan)),
                           options.only);
}

}  // namespace

void add_plan(Verb& program) {
  Verb& plan = program.add_verb("plan", "runs that need each other, as many at a time as there are threads");
  Verb& verb = plan.add_verb(
      "run", "run what is not finished of a plan (configs/plans/); the same command goes on where it was");
  const auto options = std::make_shared<PlanOptions>();
  verb.add_option("plan", &options->file,
                  "JSON file with a list of cells; configs/README.md says what they hold")
      .named("FILE")
      .required();
  verb.add_option("--out", &options->out, "folder to write the runs into").named("DIR").required();
  verb.add_option("--seed", &options->seed, "seed of all cells that name none");
  verb.add_option("--threads", &options->threads, "cells at the same time; 0 means one per processor")
      .within(0, 1024);
  verb.add_option("--rig", &options->rig_file, "rig.json of every cell").named("FILE");
  verb.add_option("--only", &options->only, "run this cell, or these ('policy_*'), and what they need")
      .named("ID");
  add_engine_option(verb, options->engine);
  verb.run = [options] { run_plan(*options); };
  add_plan_folder(plan);
}

}  // namespace lodestone::apps
