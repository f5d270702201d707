#pragma once

#include <cstdint>
#include <string>

#include "lodestone/data/dataset.h"
#include "lodestone/task/task.h"

namespace lodestone::exports {

/// How a recording becomes a dataset of Minari (Farama Foundation), the format of offline reinforcement
/// learning in Python.
struct MinariSettings {
  std::string id;         ///< "namespace/name-v0"
  task::TaskConfig task;  ///< by which rewards and ends are given; its dish is set
  std::uint64_t seed = 0;
  bool replace = false;  ///< a dataset of this id
};

struct MinariSummary {
  std::string folder;  ///< ROOT/ID
  std::int64_t episodes = 0;
  std::int64_t steps = 0;
  std::int64_t reached = 0;    ///< episodes that end at the goal
  std::int64_t raw_bytes = 0;  ///< of the numbers alone
  std::int64_t bytes = 0;      ///< of the files
};

/// The id that a recording has where none is given: lodestone/NAME-v0 of .../NAME.h5.
std::string default_minari_id(const std::string& data_path);

/// Writes ROOT/ID/data with `main_data.hdf5` and `metadata.json`, which minari.load_dataset(ID) opens where
/// MINARI_DATASETS_PATH is ROOT. Version 0.5.3 of the format; spaces are boxes of float64. Each episode has
/// the attributes id, seed and total_steps, and infos of T + 1 rows: `distance_m` and `is_success`.
///
/// The folder is there as a whole or not at all. Throws ConfigError where the id is none, or the folder
/// exists already, and IoError.
MinariSummary write_minari(const std::string& root, const data::Dataset& dataset,
                           const MinariSettings& settings);

}  // namespace lodestone::exports
