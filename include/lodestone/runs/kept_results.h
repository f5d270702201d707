#pragma once

#include <map>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "lodestone/runs/cell_record.h"
#include "lodestone/runs/plan.h"

namespace lodestone::runs {

/// What is kept of a plan's cells in a folder that outlives the runs' own, and may be carried to another
/// machine:
///
///   plan.json           the plan
///   records/ID.json     CellRecord of every finished cell
///   weights/ID/         checkpoints that unfinished cells need, and no others; recordings for good, as all
///                       that was learned rests on them and a later version may not record the same again.
///                       What no longer holds stays until its cell has been run anew
///
/// A cell with a record here is not run again, wherever it was run, unless its preset, settings or seed or
/// those of a cell it needs have changed since.
class KeptResults {
 public:
  explicit KeptResults(std::string folder);

  const std::string& folder() const { return folder_; }
  /// Ids of the plan's cells whose records are here and still hold. Throws DataError where one is damaged.
  std::unordered_set<std::string> finished(const Plan& plan, const PlanPlace& place) const;
  /// How many cells with a record here this plan has with other settings than the kept one.
  std::int64_t changed(const Plan& plan) const;
  /// Files what is finished in the plan's own folder, and drops checkpoints that nothing needs any more. A
  /// second call, with the same plan, only looks at what was not finished at the first. Throws IoError, and
  /// ConfigError where the folder keeps another plan's, by name or seed.
  void keep(const Plan& plan, const PlanPlace& place);
  /// Puts kept weights where unfinished cells look for them. Throws IoError.
  void restore(const Plan& plan, const PlanPlace& place) const;

 private:
  std::string record_file(const std::string& id) const { return folder_ + "/records/" + id + ".json"; }
  std::string weights_folder(const std::string& id) const { return folder_ + "/weights/" + id; }

  std::string folder_;
  std::optional<std::unordered_set<std::string>> filed_;  ///< after the first keep()
};

/// Records in such a folder, by id, of the cells of the plan in it as that has them now: for a page, on a
/// machine that runs nothing. Throws ConfigError where there is no plan, and DataError.
struct KeptPlan {
  Plan plan;
  std::map<std::string, CellRecord> records;
};
KeptPlan read_kept_plan(const std::string& folder);

}  // namespace lodestone::runs
