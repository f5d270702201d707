#include "lodestone/runs/slurm_queue.h"

#include <charconv>
#include <sstream>

#include "lodestone/common/error.h"
#include "lodestone/common/shell.h"

namespace lodestone::runs {

std::vector<QueuedTask> parse_queue(const std::string& text) {
  std::vector<QueuedTask> tasks;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    QueuedTask task;
    std::string state;
    std::istringstream fields(line);
    std::getline(fields, task.job, '|');
    std::getline(fields, task.index, '|');
    std::getline(fields, state, '|');
    if (!std::getline(fields, task.comment)) continue;
    task.waiting = state == "PENDING";
    task.ending = state == "COMPLETING";
    tasks.push_back(std::move(task));
  }
  return tasks;
}

std::optional<std::vector<QueuedTask>> find_queued(const std::string& name, bool each_task) {
  std::vector<std::string> words = {"squeue", "--noheader", "--me", "--name=" + name, "-o", kQueueFormat};
  if (each_task) words.emplace_back("--array");
  const common::CommandResult said = common::run_command(words);
  if (said.exit_code != 0) return std::nullopt;
  return parse_queue(said.output);
}

std::int64_t most_array_tasks() {
  const common::CommandResult said = common::run_command({"scontrol", "show", "config"});
  if (said.exit_code == 127)
    throw common::ConfigError(
        "Slurm is not installed here: run this where sbatch is, or with --engine ninja");
  const std::string key = "MaxArraySize";
  std::size_t at = said.output.find(key);
  if (at != std::string::npos) at = said.output.find_first_of("0123456789", at);
  if (said.exit_code != 0 || at == std::string::npos)
    throw common::Error("Slurm does not answer: " + said.output.substr(0, said.output.find('\n')));
  std::int64_t most = 0;
  std::from_chars(said.output.data() + at, said.output.data() + said.output.size(), most);
  if (most < 1) throw common::ConfigError("this cluster takes no job arrays (MaxArraySize = 0)");
  return most;
}

}  // namespace lodestone::runs
