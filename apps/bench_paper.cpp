#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <vector>

#include "common_options.h"
#include "lodestone/common/thread_pool.h"
#include "lodestone/experiments/paper_plan.h"
#include "lodestone/report/paper_report.h"
#include "lodestone/runs/engines.h"
#include "lodestone/runs/kept_results.h"
#include "lodestone/runs/open_cells.h"
#include "models.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

struct PaperOptions : CommonOptions {
  std::string scale = "quick";
  std::string only;
  std::string results;
  std::string from;
  std::string engine = "ninja";
  bool pace = false;
  bool list = false;
  bool report = false;
};

void list_cells(const runs::Plan& plan, const runs::PlanPlace& place) {
  const auto unfinished = runs::unfinished_cells(plan, place, runs::wanted_cells(plan));
  const std::set<const runs::Cell*> open(unfinished.begin(), unfinished.end());
  for (const runs::Cell& cell : plan.cells) {
    std::string command;
    for (const std::string& argument : runs::cell_arguments(plan, place, cell)) {
      const bool plain = argument.find_first_of(" {}[]\"'") == std::string::npos;
      command += plain ? " " + argument : " '" + argument + "'";
    }
    std::printf("%-4s %s\n         lodestone%s\n", open.count(&cell) > 0 ? "-" : "done", cell.id.c_str(),
                command.c_str());
  }
}

/// Below a run's folder, and below that of its results.
constexpr const char* kPaces = "/pace";

void write_page(const std::string& results, const std::string& folder) {
  const std::string paces = results + kPaces;
  const std::string text = report::write_paper_report(
      runs::read_kept_plan(results), runs::holds_plan(paces) ? runs::read_kept_plan(paces) : runs::KeptPlan{},
      folder);
  std::printf("%s", text.c_str());
  std::printf("report   %s/report.html\n", folder.c_str());
}

/// Keeps what is finished, and writes the page of it.
std::vector<std::string> report_command(const PaperOptions& given, const runs::PlanPlace& place) {
  std::vector<std::string> words = {"bench",      "paper",     "--report",    "--out",
                                    place.folder, "--results", place.results, "--threads",
                                    "1",          "--scale",   given.scale};
  for (const std::string& file : given.config_files) words.insert(words.end(), {"--config", file});
  for (const Override& value : given.overrides) words.insert(words.end(), {"--set", value.assignment});
  if (given.seed) words.insert(words.end(), {"--seed", std::to_string(*given.seed)});
  if (!given.rig_file.empty()) words.insert(words.end(), {"--rig", given.rig_file});
  return words;
}

void bench_paper(const PaperOptions& given) {
  PaperOptions options = given;
  if (options.from.empty() && options.scale != "smoke" && options.scale != "quick" && options.scale != "full")
    throw common::ConfigError("bench paper: --scale " + options.scale + " must be smoke, quick or full");
  if (!options.from.empty())
    return write_page(options.from, options.out.empty() ? "runs/paper-page" : options.out);
  if (options.pace && options.engine != "ninja")
    throw common::ConfigError("bench paper: --pace is measured on this machine: leave --engine out");
  if (options.out.empty()) options.out = "runs/paper-" + options.scale;
  if (options.results.empty()) options.results = options.out + "/results";
  if (!options.config_files.empty())
    options.scale = std::filesystem::path(options.config_files.back()).stem().string();
  if (options.config_files.empty())
    options.config_files = {shipped_folder("configs") + "/bench/paper_" + options.scale + ".json"};
  const auto scale = resolve_config<experiments::PaperScale>(options);
  runs::Plan plan = options.pace ? experiments::paper_pace_plan(scale) : experiments::paper_plan(scale);
  plan.name = options.scale;
  runs::PlanPlace place{options.out,
                        own_path(),
                        shipped_folder("configs"),
                        options.rig_file,
                        options.pace ? 1 : common::thread_count(scale.threads),
                        options.results};
  if (options.pace) {
    place.folder += kPaces;
    place.results += kPaces;
  }
  if (options.list) return list_cells(plan, place);
  if (!options.only.empty() && runs::cells_named(plan, options.only).empty())
    throw common::ConfigError("bench paper: there is no cell \"" + options.only +
                              "\"; --list prints all of them");
  if (options.report) {
    runs::KeptResults results(place.results);
    if (const std::int64_t n = results.changed(plan); n > 0)
      throw common::ConfigError("bench paper --report: " + place.results + " keeps " + std::to_string(n) +
                                " cells with other settings: give the --config and --set that they were run "
                                "with, or --from for the page of what is there");
    results.keep(plan, place);
  } else {
    if (options.pace && runs::unfinished_cells(plan, place, runs::wanted_cells(plan, options.only)).empty())
      std::printf("paces    measured before; to measure this machine, remove %s and %s\n",
                  place.results.c_str(), place.folder.c_str());
    if (options.only.empty() && !options.pace) place.last_command = report_command(given, place);
    const std::unique_ptr<runs::Engine> engine = runs::make_engine(options.engine);
    runs::run_plan_in_folder(plan, place, *engine, "bench paper", common::config_to_json(scale),
                             options.only);
    if (!options.only.empty()) return;
  }
  if (options.pace && !runs::holds_plan(options.results)) {
    std::printf("paces    kept in %s, for the page of the cells that are run with the same --results\n",
                place.results.c_str());
    return;
  }
  write_page(options.results, options.out);
}

}  // namespace

void add_bench_paper(Verb& bench) {
  Verb& verb = bench.add_verb(
      "paper", "the experiments of section V beside the paper's tables and figures; resumes when run again");
  auto& options = configure<experiments::PaperScale>(verb, bench_paper);
  options.rig_is = RigFile::kOfCells;
  add_common_options(verb, options);
  verb.add_option("--scale", &options.scale,
                  "smoke (about 5 min on 2 cores), quick, or full (the paper's own sizes)");
  verb.add_option("--pace", &options.pace,
                  "run instead the beginnings of Table I's trainings, one at a time, for times with nothing "
                  "beside them: leave the machine to it (about 25 min at the full scale)");
  verb.add_option("--list", &options.list, "print the cells, what is done of them, and the command of each");
  verb.add_option("--report", &options.report, "run nothing; write the report of what is done so far");
  verb.add_option("--results", &options.results,
                  "keep what is finished here, and take what is here as finished; default: OUT/results")
      .named("DIR");
  verb.add_option("--from", &options.from, "run nothing; write the report of results that were kept in DIR")
      .named("DIR");
  verb.add_option("--only", &options.only, "run this cell, or these ('mix/*/2'), and what they need")
      .named("ID");
  add_engine_option(verb, options.engine);
}

}  // namespace lodestone::apps
