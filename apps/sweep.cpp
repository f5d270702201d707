#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/config_layers.h"
#include "lodestone/common/files.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/report/sweep_report.h"
#include "lodestone/runs/engines.h"
#include "lodestone/runs/sweep.h"
#include "models.h"
#include "plan_folder.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

namespace fs = std::filesystem;

struct SweepOptions {
  std::string file;
  std::string out;
  std::string engine = "ninja";
  std::int64_t threads = 0;
  std::string rig_file;
};

std::string preset_path(const std::string& name) {
  if (fs::exists(name)) return name;
  const std::string shipped = shipped_folder("configs") + "/" + name;
  if (fs::exists(shipped)) return shipped;
  throw common::ConfigError("config: there is neither a file " + name +
                            " nor one of that name below configs/");
}

/// The presets as files whose content a sweep that goes on must find again.
std::map<std::string, std::string> preset_inputs(const runs::Sweep& sweep) {
  std::map<std::string, std::string> inputs;
  for (const std::string& name : sweep.config) inputs["preset " + name] = preset_path(name);
  return inputs;
}

/// The presets as one file in the sweep's folder; empty: there are none.
std::string write_preset(const runs::Sweep& sweep, const std::string& folder) {
  if (sweep.config.empty()) return "";
  common::ConfigLayers layers;
  for (const std::string& name : sweep.config) layers.add_file(preset_path(name));
  common::make_folders(folder);
  const std::string path = fs::absolute(folder + "/preset.json").lexically_normal().string();
  common::write_json(path, layers.json());
  return path;
}

/// A key or value that the verb does not take is told before anything is run.
void check_settings(const runs::Sweep& sweep, const std::vector<runs::SweepPoint>& points,
                    const SweepOptions& options) {
  for (const runs::SweepPoint& point : points) {
    std::vector<std::string> words;
    std::istringstream verb(sweep.verb);
    for (std::string word; verb >> word;) words.push_back(word);
    for (const std::string& name : sweep.config) words.insert(words.end(), {"--config", preset_path(name)});
    if (!options.rig_file.empty()) words.insert(words.end(), {"--rig", options.rig_file});
    for (const auto& settings : {sweep.settings, point.settings})
      for (const std::string& setting : settings) words.insert(words.end(), {"--set", setting});
    configuration_rows(words, options.file + ": ");
    if (!sweep.halving) continue;
    for (const std::int64_t rung : {std::int64_t{1}, sweep.halving->rungs}) {
      std::vector<std::string> with = words;
      with.insert(with.end(),
                  {"--set", sweep.halving->key + "=" + std::to_string(sweep.halving->budget(rung))});
      configuration_rows(with, options.file + ": ");
    }
  }
}

runs::SweepResult result_of(const runs::Sweep& sweep, const std::vector<std::vector<runs::SweepRow>>& rungs) {
  runs::SweepResult result{sweep.verb, sweep.score, sweep.lower_is_better, {}};
  std::vector<std::string> told;
  for (auto rung = rungs.rbegin(); rung != rungs.rend(); ++rung)
    for (const runs::SweepRow& row : *rung) {
      if (std::find(told.begin(), told.end(), row.point.name) != told.end()) continue;  // it came further
      told.push_back(row.point.name);
      result.rows.push_back(row);
    }
  return result;
}

std::int64_t rungs_of(const runs::Sweep& sweep) { return sweep.halving ? sweep.halving->rungs : 1; }

void write_result(const runs::Sweep& sweep, const std::vector<std::vector<runs::SweepRow>>& rungs,
                  const std::string& folder) {
  const runs::SweepResult result = result_of(sweep, rungs);
  common::write_artefact(folder + "/" + runs::SweepResult::kFile, result);
  std::printf("%s", report::write_sweep_report(result, folder).c_str());
  std::printf("report   %s/report.html\n", folder.c_str());
}

/// A sweep may grow where it was: what has been run stays as it was.
std::vector<std::string> keys_that_grow(const runs::Sweep& sweep) {
  if (sweep.halving) return {};  // its rungs chose from what there was
  if (sweep.grid.empty()) return {"seeds", "random.count"};
  return {"seeds", "grid"};
}

void run_sweep(const SweepOptions& options) {
  if (options.file.empty()) throw common::ConfigError("sweep: name a JSON file, or status, cancel or logs");
  if (options.out.empty())
    throw common::ConfigError("sweep: --out DIR is missing; name the folder to write into");
  const runs::Sweep sweep = runs::read_sweep(options.file);
  std::vector<runs::SweepPoint> points = runs::points_of(sweep);
  runs::check_verb(sweep.verb, options.file);
  check_settings(sweep, points, options);
  const runs::PlanPlace place{options.out, own_path(), shipped_folder("configs"), options.rig_file,
                              common::thread_count(options.threads)};
  runs::Plan plan;
  plan.name = fs::path(options.file).stem().string();
  plan.keep_checkpoints = false;
  std::vector<std::vector<runs::SweepRow>> rungs;
  std::string preset;
  for (std::int64_t rung = 1; rung <= rungs_of(sweep); ++rung) {
    if (rung > 1) points = runs::promoted(sweep, rungs.back());
    if (rung > 1 && runs::asked_to_stop(options.out))
      throw common::Interrupted("sweep: stopped; the same command goes on where it was");
    preset =
        sweep.config.empty() ? "" : fs::absolute(options.out + "/preset.json").lexically_normal().string();
    for (runs::Cell& cell : runs::sweep_cells(sweep, points, rung, preset))
      plan.cells.push_back(std::move(cell));
    plan.validate();
    const std::unique_ptr<runs::Engine> engine = runs::make_engine(options.engine);
    runs::run_plan_in_folder(
        plan, place, *engine, "sweep", common::artefact_to_json(sweep), "",
        [&] { write_preset(sweep, options.out); }, preset_inputs(sweep), keys_that_grow(sweep));
    rungs.push_back(runs::rung_results(sweep, points, rung, plan, place));
  }
  write_result(sweep, rungs, options.out);
}

/// The sweep that is run in a folder.
runs::Sweep sweep_in(const std::string& folder) {
  const common::Json config = common::read_json_if_there(folder + "/config.json");
  if (!config.is_object() || !config.contains("score") || !config.contains("grid"))
    throw common::ConfigError(folder +
                              " holds no sweep: name the --out of one; `lodestone status` tells of any plan");
  return common::artefact_from_json<runs::Sweep>(config, folder + "/config.json");
}

void sweep_status(const std::string& folder) {
  const runs::Sweep sweep = sweep_in(folder);
  const runs::Plan plan = runs::find_plan(folder);
  std::size_t finished = 0, running = 0;
  for (const runs::StatusRow& row : runs::status_of(folder)) {
    finished += row.state && row.state->finished ? 1 : 0;
    running += row.running ? 1 : 0;
  }
  std::printf("%zu of %zu runs are finished, %zu are running\n", finished, plan.cells.size(), running);
  std::vector<std::vector<runs::SweepRow>> rungs;
  std::vector<runs::SweepPoint> points = runs::points_of(sweep);
  const runs::PlanPlace place{folder, "", ""};
  for (std::int64_t rung = 1; rung <= rungs_of(sweep); ++rung) {
    if (rung > 1) points = runs::promoted(sweep, rungs.back());
    if (plan.find(runs::sweep_cell_id(sweep, points.front(), rung, sweep.first_seed)) == nullptr) break;
    rungs.push_back(runs::rung_results(sweep, points, rung, plan, place));
  }
  write_result(sweep, rungs, folder);
}

}  // namespace

void add_sweep(Verb& program) {
  Verb& verb = program.add_verb(
      "sweep", "seeds x settings of a verb, with intervals; the same command goes on where it was");
  const auto options = std::make_shared<SweepOptions>();
  verb.add_option("sweep", &options->file,
                  "JSON file with a verb, presets, values by key, seeds and a score; docs/sweep.md")
      .named("FILE");
  verb.add_option("--out", &options->out, "folder to write the runs, the table and the picture into")
      .named("DIR");
  verb.add_option("--threads", &options->threads, "runs at the same time; 0 means one per processor")
      .within(0, 1024);
  verb.add_option("--rig", &options->rig_file, "rig.json of every run").named("FILE");
  add_engine_option(verb, options->engine);
  verb.run = [options] { run_sweep(*options); };

  const auto folder = std::make_shared<std::string>();
  Verb& status = verb.add_verb("status", "how far it is, and the scores so far");
  status.add_option("folder", folder.get(), "the --out of a sweep").named("DIR").required();
  status.run = [folder] { sweep_status(*folder); };
  add_plan_folder(verb);
}

}  // namespace lodestone::apps
