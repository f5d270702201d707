#include "plan_folder.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/shown.h"
#include "lodestone/runs/engine.h"
#include "lodestone/runs/plan.h"
#include "lodestone/runs/slurm_engine.h"

namespace lodestone::apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLogLines = 20;

void cancel(const std::string& folder) {
  runs::find_plan(folder);
  const bool works = runs::is_running(folder);
  runs::ask_to_stop(folder);
  const char* text = "asked to stop; what was done stays, and the same command goes on where it was\n";
  if (!works && runs::cancel_left_jobs(folder))
    text =
        "the command that ran it has ended, its jobs are cancelled; the same command goes on where it was\n";
  else if (!works)
    text = "nothing works on it; the same command goes on where it was\n";
  std::printf("%s", text);
}

void logs(const std::string& folder, const std::string& id) {
  const runs::Plan plan = runs::find_plan(folder);
  const runs::PlanPlace place{folder, "", ""};
  if (!id.empty() && plan.find(id) == nullptr)
    throw common::ConfigError("logs: there is no run \"" + id + "\" in " + folder);
  for (const runs::Cell& cell : plan.cells) {
    const std::string log = runs::log_file(plan, place, cell.id);
    if (!fs::exists(log) || (!id.empty() && cell.id != id)) continue;
    const auto state = runs::find_run(runs::cell_folder(plan, place, cell.id));
    if (id.empty() && state && state->finished) continue;
    std::istringstream stream(common::read_file(log));
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);)
      lines.push_back(line.substr(line.find_last_of('\r') + 1));
    std::printf("== %s (%s)\n", cell.id.c_str(), log.c_str());
    const std::size_t first = id.empty() && lines.size() > kLogLines ? lines.size() - kLogLines : 0;
    for (std::size_t i = first; i < lines.size(); ++i) std::printf("%s\n", common::escaped(lines[i]).c_str());
  }
}

}  // namespace

void add_plan_folder(Verb& verb) {
  const auto folder = std::make_shared<std::string>();
  const auto id = std::make_shared<std::string>();
  const auto add = [&](const char* name, const char* help) -> Verb& {
    Verb& added = verb.add_verb(name, help);
    added.add_option("folder", folder.get(), "the --out of it").named("DIR").required();
    return added;
  };
  add("cancel", "stops its runs, which another process works on, wherever that is").run = [folder] {
    cancel(*folder);
  };
  Verb& shown = add("logs", "the last lines of every run that is not finished");
  shown.add_option("--run", id.get(), "all of this one").named("ID");
  shown.run = [folder, id] { logs(*folder, *id); };
}

}  // namespace lodestone::apps
