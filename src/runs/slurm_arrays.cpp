#include "lodestone/runs/slurm_arrays.h"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/shell.h"
#include "lodestone/runs/engine.h"

namespace lodestone::runs {
namespace {

/// So many cells that need the same one may each have an array of their own; more wait together.
constexpr std::int64_t kMostOfOneNeed = 32;

/// Where a cell is run.
struct Place {
  std::size_t array = 0;
  std::int64_t index = 0;
};

/// A cell, and those of its needs that are run, too.
struct Open {
  const Cell* cell = nullptr;
  std::vector<const Cell*> needs;
};

SlurmResources resources_of(const Plan& plan, const PlanPlace& place, const Cell& cell) {
  return {cell.all_threads ? place.threads : 1, cell.memory_mb ? cell.memory_mb : plan.memory_mb,
          cell.minutes ? cell.minutes : plan.minutes};
}

/// Cells by how many others have to be run before them, one after the other.
std::vector<std::vector<Open>> by_depth(const std::vector<const Cell*>& cells) {
  std::unordered_map<std::string, std::pair<const Cell*, std::size_t>> depths;
  std::vector<std::vector<Open>> steps;
  for (const Cell* cell : cells) {
    Open open{cell, {}};
    std::size_t depth = 0;
    for (const std::string& id : cell->needs()) {
      const auto need = depths.find(id);
      if (need == depths.end()) continue;
      open.needs.push_back(need->second.first);
      depth = std::max(depth, need->second.second + 1);
    }
    depths.emplace(cell->id, std::make_pair(cell, depth));
    if (steps.size() <= depth) steps.resize(depth + 1);
    steps[depth].push_back(std::move(open));
  }
  return steps;
}

class Grouping {
 public:
  Grouping(const Plan& plan, const PlanPlace& place, std::int64_t most_tasks)
      : plan_(plan), place_(place), most_tasks_(most_tasks) {}

  /// Cells that need none of each other; what they need was added before.
  void add(const std::vector<Open>& cells) {
    std::map<const Cell*, std::int64_t> times_needed;
    for (const Open& open : cells)
      if (open.needs.size() == 1) ++times_needed[open.needs.front()];
    // By resources, array of the need, and how many before have the same need; and those that wait for all.
    std::map<std::tuple<SlurmResources, std::size_t, std::int64_t>, std::vector<SlurmTask>> one_to_one;
    std::map<SlurmResources, std::vector<Open>> others;
    std::map<std::pair<SlurmResources, const Cell*>, std::int64_t> seen;
    for (const Open& open : cells) {
      const SlurmResources resources = resources_of(plan_, place_, *open.cell);
      if (open.needs.size() != 1 || times_needed[open.needs.front()] > kMostOfOneNeed) {
        others[resources].push_back(open);
        continue;
      }
      const Place need = places_.at(open.needs.front());
      const std::int64_t before = seen[{resources, open.needs.front()}]++;
      one_to_one[{resources, need.array, before}].push_back({need.index, open.cell});
    }
    for (auto& [key, tasks] : one_to_one) {
      std::sort(tasks.begin(), tasks.end(),
                [](const SlurmTask& a, const SlurmTask& b) { return a.index < b.index; });
      append({std::get<0>(key), std::move(tasks), {std::get<1>(key)}, true});
    }
    for (const auto& [resources, waiting] : others) add_others(resources, waiting);
  }
  std::vector<SlurmArray> take() { return std::move(arrays_); }

 private:
  void add_others(const SlurmResources& resources, const std::vector<Open>& cells) {
    for (std::size_t first = 0; first < cells.size(); first += static_cast<std::size_t>(most_tasks_)) {
      const std::size_t end = std::min(cells.size(), first + static_cast<std::size_t>(most_tasks_));
      std::set<std::size_t> after;
      SlurmArray array{resources, {}, {}, false};
      for (std::size_t i = first; i < end; ++i) {
        array.tasks.push_back({static_cast<std::int64_t>(i - first), cells[i].cell});
        for (const Cell* need : cells[i].needs) after.insert(places_.at(need).array);
      }
      array.after.assign(after.begin(), after.end());
      append(std::move(array));
    }
  }
  void append(SlurmArray array) {
    for (const SlurmTask& task : array.tasks) places_[task.cell] = {arrays_.size(), task.index};
    arrays_.push_back(std::move(array));
  }

  const Plan& plan_;
  const PlanPlace& place_;
  std::int64_t most_tasks_;
  std::vector<SlurmArray> arrays_;
  std::unordered_map<const Cell*, Place> places_;
};

constexpr const char* kScript = R"sh(#!/bin/sh
# One cell of a plan, as a task of a Slurm array. $1 holds a line for each: INDEX LOG FOLDER NEED... -- COMMAND...
#SBATCH --requeue --nodes=1 --ntasks=1 --mem=4096M --open-mode=append --kill-on-invalid-dep=yes
#SBATCH --signal=B:USR1@60
finished() { grep -qs '"finished": *true' "$1/run.json"; }
eval "set -- $(sed -n "/^$SLURM_ARRAY_TASK_ID /{s/^[0-9]* //p;q;}" "$1")"
log=$1 folder=$2
shift 2
exec >> "$log" 2>&1
while [ "$1" != -- ]; do
  # A shared folder may show half a minute late what another machine wrote.
  finished "$1" || sleep 30
  finished "$1" || { echo "not run: it needs $1, which is not finished"; exit 0; }
  shift
done
shift
trap stopped=yes TERM  # to stop, or to make room: Slurm tells the cell, too, and requeues what makes room
trap 'late=yes; kill -TERM "$cell"' USR1  # the time is nearly up
"$@" &
cell=$!
while wait "$cell"; code=$?; kill -0 "$cell" 2> /dev/null; do :; done
if finished "$folder"; then
  AFTER
  exit 0
fi
sleep 1
if [ -z "$stopped" ] && { [ -n "$late" ] || [ "$code" -gt 128 ]; } && [ "${SLURM_RESTART_COUNT:-0}" -lt 3 ]; then
  echo "ended before its end (exit code $code): it is run again, and goes on where it was"
  scontrol requeue "$SLURM_JOB_ID" && sleep 60
fi
exit "$code"
)sh";

}  // namespace

std::vector<SlurmArray> slurm_arrays(const Plan& plan, const PlanPlace& place,
                                     const std::vector<const Cell*>& cells, std::int64_t most_tasks) {
  Grouping grouping(plan, place, most_tasks);
  for (const std::vector<Open>& step : by_depth(cells)) grouping.add(step);
  return grouping.take();
}

std::string slurm_indices(const SlurmArray& array) {
  std::string text;
  for (std::size_t first = 0; first < array.tasks.size();) {
    std::size_t last = first;
    while (last + 1 < array.tasks.size() && array.tasks[last + 1].index == array.tasks[last].index + 1)
      ++last;
    text += (text.empty() ? "" : ",") + std::to_string(array.tasks[first].index);
    if (last > first) text += "-" + std::to_string(array.tasks[last].index);
    first = last + 1;
  }
  return text;
}

std::string slurm_lines(const Plan& plan, const PlanPlace& place, const SlurmArray& array) {
  std::string text;
  for (const SlurmTask& task : array.tasks) {
    std::vector<std::string> words = {log_file(plan, place, task.cell->id),
                                      cell_folder(plan, place, task.cell->id)};
    for (const std::string& need : task.cell->needs()) words.push_back(cell_folder(plan, place, need));
    words.insert(words.end(), {"--", place.program});
    for (std::string& argument : cell_arguments(plan, place, *task.cell))
      words.push_back(std::move(argument));
    const std::string line = std::to_string(task.index) + " " + common::shell_quoted(words);
    if (line.find('\n') != std::string::npos)
      throw common::ConfigError("cell \"" + task.cell->id + "\": a setting must be one line for Slurm");
    text += line + "\n";
  }
  return text;
}

std::string slurm_script(const Plan& plan) {
  std::string text = kScript;
  const std::string place = "AFTER";
  return text.replace(text.find(place), place.size(),
                      plan.keep_checkpoints ? ":" : "rm -rf \"$folder/training\"");
}

}  // namespace lodestone::runs
