#include "lodestone/runs/kept_results.h"

#include <filesystem>
#include <set>
#include <utility>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"

namespace lodestone::runs {
namespace {

namespace fs = std::filesystem;

/// What others read of a cell's folder, and what says that it is finished.
constexpr const char* kNeeded[] = {"transitions.h5", "checkpoint", "config.json", "manifest.json",
                                   "run.json"};

bool finished_in(const std::string& folder) {
  const auto state = find_run(folder);
  return state && state->finished;
}

/// In one step, so that a kill leaves all of it or nothing.
void copy_needed(const std::string& from, const std::string& to) {
  const std::string staged = to + ".part";
  fs::remove_all(staged);
  common::make_folders(staged);
  for (const char* name : kNeeded)
    if (fs::exists(from + "/" + name))
      fs::copy(from + "/" + name, staged + "/" + name, fs::copy_options::recursive);
  fs::rename(staged, to);
}

/// Ids of cells that others need which have no record.
std::set<std::string> needed(const Plan& plan, const std::map<std::string, CellRecord>& records) {
  std::set<std::string> ids;
  for (const Cell& cell : plan.cells) {
    if (records.count(cell.id) > 0) continue;
    for (const std::string& need : cell.needs()) ids.insert(need);
  }
  return ids;
}

}  // namespace

KeptResults::KeptResults(std::string folder) : folder_(std::move(folder)) {}

std::map<std::string, CellRecord> KeptResults::records(const Plan& plan, const PlanPlace& place) const {
  std::map<std::string, CellRecord> found;
  for (const Cell& cell : plan.cells) {  // each after those it needs
    auto record = common::find_artefact<CellRecord>(record_file(cell.id));
    if (!record || !is_record_of(*record, plan, place, cell)) continue;
    bool holds = true;
    for (const std::string& need : cell.needs()) holds = holds && found.count(need) > 0;
    if (holds) found.emplace(cell.id, std::move(*record));
  }
  return found;
}

void KeptResults::keep(const Plan& plan, const PlanPlace& place) const {
  write_plan(plan, folder_);
  std::map<std::string, CellRecord> known = records(plan, place);
  for (const Cell& cell : plan.cells) {
    if (known.count(cell.id) > 0 || !finished_in(cell_folder(plan, place, cell.id))) continue;
    const CellRecord record = record_of(plan, place, cell);
    common::make_folders(fs::path(record_file(cell.id)).parent_path().string());
    common::write_file_atomically(record_file(cell.id), common::artefact_to_json(record).dump() + "\n");
    known.emplace(cell.id, record);
  }
  const std::set<std::string> wanted = needed(plan, known);
  for (const Cell& cell : plan.cells) {
    const std::string kept = weights_folder(cell.id);
    if (wanted.count(cell.id) == 0) {
      fs::remove_all(kept);
    } else if (const std::string run = cell_folder(plan, place, cell.id);
               !fs::exists(kept) && finished_in(run)) {
      common::make_folders(fs::path(kept).parent_path().string());
      copy_needed(run, kept);
    }
  }
}

void KeptResults::restore(const Plan& plan, const PlanPlace& place) const {
  for (const std::string& id : needed(plan, records(plan, place))) {
    const std::string run = cell_folder(plan, place, id);
    if (fs::exists(run) || !finished_in(weights_folder(id))) continue;
    common::make_folders(fs::path(run).parent_path().string());
    copy_needed(weights_folder(id), run);
  }
}

KeptPlan read_kept_plan(const std::string& folder) {
  KeptPlan kept;
  kept.plan = find_plan(folder);
  for (const Cell& cell : kept.plan.cells)
    if (auto record = common::find_artefact<CellRecord>(folder + "/records/" + cell.id + ".json"))
      kept.records.emplace(cell.id, std::move(*record));
  return kept;
}

}  // namespace lodestone::runs
