#include "lodestone/runs/ninja_engine.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <thread>
#include <utility>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/progress.h"

namespace lodestone::runs {
namespace {

namespace fs = std::filesystem;

std::string log_of(const Plan& plan, const PlanPlace& place, const std::string& id) {
  return cell_folder(plan, place, id) + ".log";
}

/// For the shell that ninja starts.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// For ninja: in values and, with spaces and colons, in paths.
std::string escaped(const std::string& text, bool path = false) {
  std::string out;
  for (const char c : text) {
    if (c == '$' || (path && (c == ' ' || c == ':'))) out += '$';
    out += c;
  }
  return out;
}

std::string stamp(const PlanPlace& place, const std::string& id) {
  return escaped(place.folder + "/stamps/" + id, true);
}

std::string find_ninja() {
  std::istringstream folders(std::getenv("PATH") != nullptr ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((folder + "/ninja").c_str(), X_OK) == 0) return folder + "/ninja";
  throw common::ConfigError(
      "ninja is not installed, which runs the cells of a plan: apt-get install ninja-build");
}

/// Ninja in a process of its own, its output in a file. It is told to stop when this process dies.
pid_t start(std::vector<std::string> command, const std::string& log) {
  std::vector<char*> argv;
  for (std::string& argument : command) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const int out = ::open(log.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0644);
  if (out < 0) throw common::IoError("cannot write " + log + ": check the folder and the space on the disk");
  const pid_t child = ::fork();
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(out, STDERR_FILENO);
    ::execv(argv.front(), argv.data());
    ::_exit(127);
  }
  ::close(out);
  if (child < 0) throw common::IoError("cannot start ninja: too many processes are running");
  return child;
}

/// The last line that a cell wrote.
std::string last_line(const std::string& log) {
  if (!fs::exists(log)) return "it said nothing";
  std::istringstream lines(common::read_file(log));
  std::string last = "it said nothing";
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) last = line.substr(line.find_last_of('\r') + 1);
  return last;
}

/// Cells that are wanted: all, or one with all it needs.
std::vector<const Cell*> wanted_cells(const Plan& plan, const std::string& only) {
  std::vector<const Cell*> wanted;
  std::vector<std::string> open = {only};
  if (only.empty())
    for (const Cell& cell : plan.cells) wanted.push_back(&cell);
  while (!only.empty() && !open.empty()) {
    const Cell* cell = plan.find(open.back());
    if (cell == nullptr) throw common::ConfigError("the plan has no cell \"" + open.back() + "\"");
    open.pop_back();
    if (std::find(wanted.begin(), wanted.end(), cell) != wanted.end()) continue;
    wanted.push_back(cell);
    for (const std::string& need : cell->needs()) open.push_back(need);
  }
  return wanted;
}

/// Shows how far the cells are; returns those that are not finished.
std::vector<const Cell*> look(const Plan& plan, const PlanPlace& place, const std::vector<const Cell*>& cells,
                              common::Progress& progress) {
  std::vector<const Cell*> left;
  std::string running;
  for (const Cell* cell : cells) {
    const std::string folder = cell_folder(plan, place, cell->id);
    const std::optional<RunState> state = find_run(folder);
    if (state && state->finished) continue;
    left.push_back(cell);
    if (!state || !is_running(folder)) continue;
    running += (running.empty() ? "" : ", ") + cell->id;
    if (state->total > 0) running += " " + std::to_string(100 * state->done / state->total) + " %";
  }
  progress.update(static_cast<std::int64_t>(cells.size() - left.size()), running);
  return left;
}

}  // namespace

std::string ninja_text(const Plan& plan, const PlanPlace& place) {
  std::string text =
      "ninja_required_version = 1.5\nbuilddir = " + escaped(place.folder + "/stamps", true) +
      "\npool wide\n  depth = 1\nrule cell\n  command = $run >> $log 2>&1 && $after touch $stamp\n"
      "  description = $id\n\n";
  for (const Cell& cell : plan.cells) {
    text += "build " + stamp(place, cell.id) + ": cell";
    const std::vector<std::string> needs = cell.needs();
    if (!needs.empty()) text += " |";
    for (const std::string& need : needs) text += " " + stamp(place, need);
    std::string run = quoted(place.program);
    for (const std::string& argument : cell_arguments(plan, place, cell)) run += " " + quoted(argument);
    const std::string training = cell_folder(plan, place, cell.id) + "/training";
    text += "\n  id = " + escaped(cell.id) + "\n  run = " + escaped(run) +
            "\n  log = " + escaped(quoted(log_of(plan, place, cell.id))) +
            "\n  stamp = " + escaped(quoted(place.folder + "/stamps/" + cell.id)) +
            "\n  after = " + (plan.keep_checkpoints ? "" : escaped("rm -rf " + quoted(training) + " &&")) +
            (cell.all_threads ? "\n  pool = wide" : "") + "\n\n";
  }
  return text;
}

void run_plan(const Plan& plan, const PlanPlace& place, const std::string& label, const std::string& only) {
  plan.validate();
  const std::vector<const Cell*> cells = wanted_cells(plan, only);
  const std::string ninja = find_ninja();
  common::make_folders(place.folder);
  for (const Cell& cell : plan.cells)
    common::make_folders(fs::path(log_of(plan, place, cell.id)).parent_path().string());
  write_plan(plan, place.folder);
  common::write_file_atomically(place.folder + "/build.ninja", ninja_text(plan, place));
  std::vector<std::string> command = {ninja, "-f", place.folder + "/build.ninja", "-k",
                                      "0",   "-j", std::to_string(place.threads)};
  if (!only.empty()) command.push_back(place.folder + "/stamps/" + only);
  const pid_t child = start(command, place.folder + "/ninja.log");
  common::Progress progress(label, static_cast<std::int64_t>(cells.size()));
  bool told = false;
  int status = 0;
  for (int ticks = 0; ::waitpid(child, &status, WNOHANG) == 0; ++ticks) {
    if (common::interrupted() && !std::exchange(told, true)) ::kill(child, SIGTERM);
    if (ticks % 20 == 0) look(plan, place, cells, progress);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  const std::vector<const Cell*> left = look(plan, place, cells, progress);
  progress.finish();
  if (common::interrupted())
    throw common::Interrupted(label + ": stopped; the same command goes on where it was");
  if (left.empty()) return;
  std::string first;
  for (const Cell* cell : left) {
    const std::string log = log_of(plan, place, cell->id);
    if (first.empty() && fs::exists(log))
      first = "; the first, " + cell->id + ": " + last_line(log) + " (" + log + ")";
  }
  throw common::Error(label + ": " + std::to_string(left.size()) + " of " + std::to_string(cells.size()) +
                      " cells are not finished" + first);
}

void run_plan_in_folder(const Plan& plan, const PlanPlace& place, const std::string& verb,
                        common::Json settings, const std::string& only) {
  settings["rig_file"] = place.rig_file;
  RunFolder run({place.folder, verb, settings, plan.seed, /*resume=*/true});
  run.begin();
  run_plan(plan, place, verb, only);
  if (only.empty()) run.finish();
}

}  // namespace lodestone::runs
