#include <algorithm>
#include <cstdio>
#include <memory>
#include <thread>

#include "lodestone/common/artefact.h"
#include "lodestone/runs/ninja_engine.h"
#include "models.h"
#include "verb.h"

namespace lodestone::apps {
namespace {

struct PlanOptions {
  std::string file;
  std::string out;
  std::optional<std::int64_t> seed;
  std::int64_t threads = 0;
  std::string only;
  std::string rig_file;
};

void run_plan(const PlanOptions& options) {
  runs::Plan plan = runs::read_plan(options.file);
  if (options.seed) plan.seed = *options.seed;
  // A folder holds one plan and seed: cells of another would stand in the same places.
  common::Json settings = common::artefact_to_json(plan);
  settings["rig_file"] = options.rig_file;
  runs::RunFolder run({options.out, "plan run", settings, plan.seed, /*resume=*/true});
  run.begin();
  const std::int64_t threads =
      options.threads > 0 ? options.threads : std::max<std::int64_t>(1, std::thread::hardware_concurrency());
  runs::run_plan(plan, {options.out, own_path(), shipped_folder("configs"), options.rig_file, threads},
                 "plan", options.only);
  if (options.only.empty()) run.finish();
}

}  // namespace

void add_plan(CLI::App& program, ConfigCatalogue&) {
  CLI::App* verb =
      program.add_subcommand("plan", "runs that need each other, as many at a time as there are threads");
  verb->require_subcommand(1);
  CLI::App* run = verb->add_subcommand(
      "run", "run what is not finished of a plan (configs/plans/); the same command goes on where it was");
  auto options = std::make_shared<PlanOptions>();
  run->add_option("plan", options->file,
                  "JSON file with a list of cells; configs/README.md says what they hold")
      ->type_name("FILE")
      ->required();
  run->add_option("--out", options->out, "folder to write the runs into")->type_name("DIR")->required();
  run->add_option("--seed", options->seed, "seed of all cells that name none");
  run->add_option("--threads", options->threads, "cells at the same time; 0 means one per processor")
      ->check(CLI::Range(0, 1024));
  run->add_option("--rig", options->rig_file, "rig.json of every cell")->type_name("FILE");
  run->add_option("--only", options->only, "run this cell, and what it needs")->type_name("ID");
  run->callback([options] { run_plan(*options); });
}

}  // namespace lodestone::apps
