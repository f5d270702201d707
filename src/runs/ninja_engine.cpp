#include "lodestone/runs/ninja_engine.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <vector>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/shell.h"

namespace lodestone::runs {
namespace {

namespace fs = std::filesystem;
using common::shell_quoted;

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
pid_t start_process(std::vector<std::string> command, const std::string& log) {
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

}  // namespace

std::string ninja_text(const Plan& plan, const PlanPlace& place, const std::vector<const Cell*>& cells) {
  std::set<std::string> ids;
  for (const Cell* cell : cells) ids.insert(cell->id);
  std::string text = "ninja_required_version = 1.5\nbuilddir = " + escaped(place.folder + "/stamps", true) +
                     "\npool wide\n  depth = 1\nrule cell\n  command = trap : TERM; $run >> $log 2>&1 && "
                     "$after touch $stamp\n"
                     "  description = $id\n\n";
  for (const Cell* cell : cells) {
    text += "build " + stamp(place, cell->id) + ": cell";
    std::string needs;
    for (const std::string& need : cell->needs())
      if (ids.count(need) > 0) needs += " " + stamp(place, need);
    if (!needs.empty()) text += " |" + needs;
    const std::string run =
        shell_quoted(place.program) + " " + shell_quoted(cell_arguments(plan, place, *cell));
    const std::string training = cell_folder(plan, place, cell->id) + "/training";
    text += "\n  id = " + escaped(cell->id) + "\n  run = " + escaped(run) +
            "\n  log = " + escaped(shell_quoted(log_file(plan, place, cell->id))) +
            "\n  stamp = " + escaped(shell_quoted(place.folder + "/stamps/" + cell->id)) + "\n  after = " +
            (plan.keep_checkpoints ? "" : escaped("rm -rf " + shell_quoted(training) + " &&")) +
            (cell->all_threads ? "\n  pool = wide" : "") + "\n\n";
  }
  return text;
}

void NinjaEngine::start(const Plan& plan, const PlanPlace& place, const std::vector<const Cell*>& cells) {
  const std::string ninja = find_ninja();
  fs::remove_all(place.folder + "/stamps");  // these cells have to be run, whatever was before
  PlanPlace here = place;
  here.cell_threads = std::max<std::int64_t>(1, place.threads / static_cast<std::int64_t>(cells.size()));
  common::write_file_atomically(place.folder + "/build.ninja", ninja_text(plan, here, cells));
  process_ = start_process(
      {ninja, "-f", place.folder + "/build.ninja", "-k", "0", "-j", std::to_string(place.threads)},
      place.folder + "/ninja.log");
}

bool NinjaEngine::ended() {
  if (process_ >= 0 && ::waitpid(process_, nullptr, WNOHANG) != 0) process_ = -1;
  return process_ < 0;
}

void NinjaEngine::stop() {
  if (process_ >= 0) ::kill(process_, SIGTERM);
}

}  // namespace lodestone::runs
