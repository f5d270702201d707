#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/experiments/tasks_plan.h"
#include "lodestone/experiments/tasks_summary.h"
#include "lodestone/report/tasks_report.h"
#include "lodestone/rig/rig_config.h"
#include "lodestone/runs/engines.h"
#include "lodestone/runs/open_cells.h"
#include "models.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

struct TasksOptions : CommonOptions {
  std::string scale = "full";
  std::string only;
  std::string engine = "ninja";
  bool report = false;
};

/// Cells are told where things are, whatever folder they run in.
std::string whole_path(const std::string& path) {
  return std::filesystem::absolute(path).lexically_normal().string();
}

rig::RigConfig rig_of_cells(const std::string& file) {
  if (file.empty()) return {};  // the paper's
  return common::config_from_json<rig::RigConfig>(common::read_json_file(file), file);
}

void write_tasks_page(const runs::Plan& plan, const runs::PlanPlace& place, const rig::RigConfig& rig) {
  common::make_folders(place.folder);
  common::write_artefact(place.folder + "/" + runs::TasksSummary::kFile,
                         experiments::summarise_tasks(plan, place, rig));
  const std::string page = place.folder + "/report.html";
  std::printf("%sreport   %s\n", report::write_tasks_report(place.folder, page).c_str(), page.c_str());
}

/// Writes the page of what is finished.
std::vector<std::string> page_command(const TasksOptions& given, const runs::PlanPlace& place) {
  std::vector<std::string> words = {"bench",     "tasks", "--report", "--out",    place.folder,
                                    "--threads", "1",     "--scale",  given.scale};
  for (const std::string& file : given.config_files) words.insert(words.end(), {"--config", file});
  for (const Override& value : given.overrides) words.insert(words.end(), {"--set", value.assignment});
  if (given.seed) words.insert(words.end(), {"--seed", std::to_string(*given.seed)});
  if (!given.rig_file.empty()) words.insert(words.end(), {"--rig", given.rig_file});
  return words;
}

void bench_tasks(const TasksOptions& given) {
  TasksOptions options = given;
  if (options.scale != "smoke" && options.scale != "full")
    throw common::ConfigError("bench tasks: --scale " + options.scale + " must be smoke or full");
  if (options.out.empty()) options.out = "runs/tasks-" + options.scale;
  if (options.config_files.empty())
    options.config_files = {shipped_folder("configs") + "/bench/tasks_" + options.scale + ".json"};
  auto scale = resolve_config<experiments::TasksScale>(options);
  if (scale.models.empty()) scale.models = shipped_folder("models");
  scale.models = whole_path(scale.models);
  const std::string out = whole_path(options.out);
  const rig::RigConfig rig = rig_of_cells(options.rig_file);
  const runs::Plan plan = experiments::tasks_plan(scale, rig, out);
  runs::PlanPlace place{out, own_path(), shipped_folder("configs"), options.rig_file,
                        common::thread_count(scale.threads)};
  if (!options.only.empty() && runs::cells_named(plan, options.only).empty())
    throw common::ConfigError("bench tasks: there is no cell \"" + options.only +
                              "\"; name one as TASK/CONTROLLER/bare or TASK/CONTROLLER/decorated");
  if (!options.report) {
    if (options.only.empty()) place.last_command = page_command(given, place);
    const std::unique_ptr<runs::Engine> engine = runs::make_engine(options.engine);
    runs::run_plan_in_folder(plan, place, *engine, "bench tasks", common::config_to_json(scale), options.only,
                             [&out] { experiments::write_figure_of_eight(out); });
  }
  write_tasks_page(plan, place, rig);
}

}  // namespace

void add_bench_tasks(Verb& bench) {
  Verb& verb = bench.add_verb(
      "tasks",
      "poses, headings along paths, sutures, obstacles, flow and speed: every controller on the "
      "same rigs that nobody has seen; resumes when run again");
  auto& options = configure<experiments::TasksScale>(verb, bench_tasks);
  options.rig_is = RigFile::kOfCells;
  add_common_options(verb, options, /*with_resume=*/true);
  verb.add_option("--scale", &options.scale,
                  "full (200 trials of each task by each controller, by camera), or smoke: does it run?");
  add_shorthand(verb, options, "--trials", "trials", Shorthand::kValue,
                "trials of each task by each controller");
  add_shorthand(
      verb, options, "--tasks", "tasks", Shorthand::kText,
      "only these, with commas between: pose, pose_wide, suture, obstacles, tangent_path, flow, still, "
      "square_at_mm_s");
  add_shorthand(verb, options, "--controllers", "controllers", Shorthand::kText,
                "with commas between: planner, policy, baseline, observer");
  add_shorthand(verb, options, "--models", "models", Shorthand::kText,
                "folder that holds the policies `any_rig` and `any_pose` and the simulator `dynamics_best`");
  add_shorthand(verb, options, "--sensor", "sensor", Shorthand::kText, "camera or simulated");
  verb.add_option("--only", &options.only, "run this cell, or these ('suture/*')").named("ID");
  verb.add_option("--report", &options.report, "run nothing; write the report of what is done so far");
  add_engine_option(verb, options.engine);
}

}  // namespace lodestone::apps
