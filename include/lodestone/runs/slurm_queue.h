#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lodestone::runs {

/// A job, or a task of an array, that is waiting or running.
struct QueuedTask {
  std::string job;       ///< of the array
  std::string index;     ///< of the task; "N/A": it is no array
  bool waiting = false;  ///< it has not begun, or will begin again
  bool ending = false;   ///< it is being cleaned away, and will not begin again
  std::string comment;   ///< as given to sbatch
  std::string name() const { return index == "N/A" ? job : job + "_" + index; }  ///< for a dependency
};

/// What `squeue -o kQueueFormat` prints.
constexpr const char* kQueueFormat = "%F|%K|%T|%k";
std::vector<QueuedTask> parse_queue(const std::string& text);

/// Our jobs of a name; nothing where Slurm does not answer right now. `each_task`: tasks of arrays that wait
/// are named one by one, too, which takes longer.
std::optional<std::vector<QueuedTask>> find_queued(const std::string& name, bool each_task);

/// How many tasks the cluster takes in an array. Throws ConfigError where Slurm is not installed, and Error
/// where it does not answer.
std::int64_t most_array_tasks();

}  // namespace lodestone::runs
