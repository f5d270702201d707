#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "lodestone/runs/plan.h"

namespace lodestone::runs {

/// What a task asks of the cluster.
struct SlurmResources {
  std::int64_t cpus = 1;
  std::optional<std::int64_t> memory_mb, minutes;

  bool operator<(const SlurmResources& other) const {
    return std::tie(cpus, memory_mb, minutes) < std::tie(other.cpus, other.memory_mb, other.minutes);
  }
};

struct SlurmTask {
  std::int64_t index = 0;
  const Cell* cell = nullptr;
};

/// One job array: cells that ask for the same, a task each, by increasing index.
struct SlurmArray {
  SlurmResources resources;
  std::vector<SlurmTask> tasks;
  std::vector<std::size_t> after;  ///< arrays before this one that have what its cells need
  bool one_to_one = false;         ///< a task needs nothing but that of the same index in after.front()
};

/// Cells as job arrays, each after those that it needs, with indices below `most_tasks`. Cells that each need
/// one cell of the same array wait for that task alone, unless a great many need the same one.
std::vector<SlurmArray> slurm_arrays(const Plan& plan, const PlanPlace& place,
                                     const std::vector<const Cell*>& cells, std::int64_t most_tasks);

/// Indices of its tasks, as sbatch takes them: "0-99,101".
std::string slurm_indices(const SlurmArray& array);

/// What slurm_script() reads: for each task a line "INDEX LOG FOLDER NEED... -- COMMAND...", in words of the
/// shell. Throws ConfigError where a text has several lines.
std::string slurm_lines(const Plan& plan, const PlanPlace& place, const SlurmArray& array);

/// The script that every task runs, given the file of slurm_lines(). It says in the cell's log why a cell was
/// not run, and runs one again (a few times) that was killed, or whose time was up.
std::string slurm_script(const Plan& plan);

}  // namespace lodestone::runs
