#pragma once

#include <string>
#include <vector>

namespace lodestone::experiments {

/// Whether a task is named by the file that describes it (FILE.json).
bool is_task_file(const std::string& task);

/// What a file that describes a task sets in a deployment's configuration, as "key=value", which
/// common::apply_override() reads; what these values may be is checked there. The file holds
///
///     {"task": "path", "path": "way.csv", "heading": "tangent"}
///
/// `task`: one of runs::kTasks. `path`: of the task "path", a CSV file as seen from this one's folder.
/// `heading`: none, tangent, column, or degrees. `stitches`: of the task "suture", a list of StitchConfig, or
/// how many there are in a row. `flow`: as_rig, steady or pulsing. And, in the units of the keys that they
/// set: `target_mm`, `side_m`, `radius_m`, `speed_m_s`, `laps`, `seconds`, `length_m`, `pitch_m`. Throws
/// ConfigError naming the file and what is wrong in it.
std::vector<std::string> settings_of_task(const std::string& file);

}  // namespace lodestone::experiments
