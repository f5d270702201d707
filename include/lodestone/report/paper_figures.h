#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/runs/kept_results.h"
#include "lodestone/runs/paper_result.h"

namespace lodestone::report {

/// Records of the training seeds of what is called the same otherwise.
struct SeedRecords {
  std::vector<std::pair<std::int64_t, const runs::CellRecord*>> found;  ///< by seed
  std::int64_t planned = 0;
};

/// Cells "PREFIX/SEED" by PREFIX, in the order in which the plan first names them. `kept` must outlive them.
std::vector<std::pair<std::string, SeedRecords>> by_prefix(const runs::KeptPlan& kept);

/// Those of the seeds that others have, too.
SeedRecords with_seeds_of(const SeedRecords& seeds, const SeedRecords& others);

/// How learning went. All of them are trainings with a curve that is not empty.
runs::PooledTraining pooled_training(const SeedRecords& seeds);

/// All figures of the paper's experiments, and of their paces (experiments::paper_pace_plan()). Pooled over
/// what is there; what is not there at all has no entry.
runs::PaperResult paper_figures(const runs::KeptPlan& kept, const runs::KeptPlan& paces = {});

}  // namespace lodestone::report
