#include "paper_bench.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <thread>
#include <utility>

#include "lodestone/experiments/paper_plan.h"
#include "lodestone/report/paper_report.h"
#include "lodestone/runs/ninja_engine.h"
#include "models.h"

namespace lodestone::apps {
namespace {

struct PaperOptions {
  std::string scale = "quick";
  std::string only;
  bool list = false;
  bool report = false;
};

void list_cells(const runs::Plan& plan, const runs::PlanPlace& place) {
  for (const runs::Cell& cell : plan.cells) {
    std::string command;
    for (const std::string& argument : runs::cell_arguments(plan, place, cell)) {
      const bool plain = argument.find_first_of(" {}[]\"'") == std::string::npos;
      command += plain ? " " + argument : " '" + argument + "'";
    }
    const auto state = runs::find_run(runs::cell_folder(plan, place, cell.id));
    std::printf("%-4s %s\n         lodestone%s\n", state && state->finished ? "done" : "-", cell.id.c_str(),
                command.c_str());
  }
}

void bench_paper(CommonOptions options, const PaperOptions& paper) {
  if (paper.scale != "smoke" && paper.scale != "quick" && paper.scale != "full")
    throw common::ConfigError("bench paper: --scale " + paper.scale + " must be smoke, quick or full");
  if (options.out.empty()) options.out = "runs/paper-" + paper.scale;
  if (options.config_files.empty())
    options.config_files = {shipped_folder("configs") + "/bench/paper_" + paper.scale + ".json"};
  const std::string rig_file = std::exchange(options.rig_file, "");  // the cells' own
  const auto scale = resolve_config<experiments::PaperScale>(options);
  const runs::Plan plan = experiments::paper_plan(scale);
  const std::int64_t threads =
      scale.threads > 0 ? scale.threads : std::max<std::int64_t>(1, std::thread::hardware_concurrency());
  const runs::PlanPlace place{options.out, own_path(), shipped_folder("configs"), rig_file, threads};
  if (paper.list) return list_cells(plan, place);
  if (!paper.only.empty() && plan.find(paper.only) == nullptr)
    throw common::ConfigError("bench paper: there is no cell \"" + paper.only +
                              "\"; --list prints all of them");
  if (!paper.report) {
    // A folder holds one scale and seed: cells of another would stand in the same places.
    common::Json settings = common::config_to_json(scale);
    settings["rig_file"] = rig_file;
    runs::RunFolder run({options.out, "bench paper", settings, scale.seed, /*resume=*/true});
    run.begin();
    runs::run_plan(plan, place, "bench paper", paper.only);
    if (!paper.only.empty()) return;
    run.finish();
  }
  std::printf("%s", report::write_paper_report(options.out, paper.scale).c_str());
  std::printf("report   %s/report.html\n", options.out.c_str());
}

}  // namespace

void add_bench_paper(CLI::App& bench, ConfigCatalogue& catalogue) {
  CLI::App* verb = bench.add_subcommand(
      "paper", "the experiments of section V beside the paper's tables and figures; resumes when run again");
  auto options = std::make_shared<CommonOptions>();
  auto paper = std::make_shared<PaperOptions>();
  catalogue["bench paper"] = [options] { return describe_resolved<experiments::PaperScale>(*options); };
  add_common_options(*verb, *options);
  verb->add_option("--scale", paper->scale,
                   "smoke (about 2 min on 2 cores), quick (20 to 40) or full (overnight)");
  verb->add_flag("--list", paper->list, "print the cells, what is done of them, and the command of each");
  verb->add_flag("--report", paper->report, "run nothing; write the report of what is done so far");
  verb->add_option("--only", paper->only, "run this cell, and what it needs")->type_name("ID");
  verb->callback([options, paper] { bench_paper(*options, *paper); });
}

}  // namespace lodestone::apps
