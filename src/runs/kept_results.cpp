#include "lodestone/runs/kept_results.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"

namespace lodestone::runs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecording = "transitions.h5";
/// What others read of a cell's folder, and what says that it is finished.
constexpr const char* kNeeded[] = {kRecording, "checkpoint", "config.json", "manifest.json", "run.json"};

bool finished_in(const std::string& folder) {
  const auto state = find_run(folder);
  return state && state->finished;
}

/// All that was written of it lies on the disk.
void sync_tree(const std::string& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) common::sync_path(entry.path().string());
  common::sync_path(folder);
}

/// In one step, so that a kill leaves all of it or nothing. Another process may be doing the same.
void copy_needed(const std::string& from, const std::string& to) {
  const std::string staged = to + ".part" + std::to_string(::getpid());
  fs::remove_all(staged);
  common::make_folders(staged);
  for (const char* name : kNeeded)
    if (fs::exists(from + "/" + name))
      fs::copy(from + "/" + name, staged + "/" + name, fs::copy_options::recursive);
  sync_tree(staged);
  std::error_code error;
  fs::rename(staged, to, error);
  if (error) fs::remove_all(staged);
  if (error && !fs::exists(to)) throw common::IoError("cannot write " + to + ": " + error.message());
  common::sync_path(fs::path(to).parent_path().string());
}

/// A tree without files, which no commit holds, would be left otherwise.
void remove_with_empty_parents(const std::string& folder, const std::string& root) {
  fs::remove_all(folder);
  std::error_code not_empty;
  for (fs::path at = fs::path(folder).parent_path(); at != root && fs::remove(at, not_empty);)
    at = at.parent_path();
}

/// Results of another plan would be taken for outdated ones of this.
void check_same_plan(const std::string& folder, const Plan& plan) {
  if (!holds_plan(folder)) return;
  const Plan kept = find_plan(folder);
  if (kept.name == plan.name && kept.seed == plan.seed) return;
  throw common::ConfigError(
      fmt::format("{} keeps results of the plan \"{}\" with seed {}, and this is \"{}\" with seed {}: name "
                  "that one, or another folder of results",
                  folder, kept.name, kept.seed, plan.name, plan.seed));
}

/// Ids of cells that others need which are not finished.
std::unordered_set<std::string> needed(const Plan& plan, const std::unordered_set<std::string>& finished) {
  std::unordered_set<std::string> ids;
  for (const Cell& cell : plan.cells) {
    if (finished.count(cell.id) > 0) continue;
    for (const std::string& need : cell.needs()) ids.insert(need);
  }
  return ids;
}

/// A page would read past the end of the shorter ones.
void check_curve(const CellRecord& record, const std::string& file) {
  if (!record.curve) return;
  const KeptCurve& curve = *record.curve;
  const std::size_t evaluations = curve.env_steps.size();
  for (const auto* list :
       {&curve.episode_return, &curve.success_rate, &curve.seconds, &curve.processor_seconds})
    if (list->size() != evaluations)
      throw common::DataError(file +
                              ": curve: the lists of evaluations differ in length; the file is damaged: "
                              "remove it, and run the cell again");
}

}  // namespace

KeptResults::KeptResults(std::string folder) : folder_(std::move(folder)) {}

std::unordered_set<std::string> KeptResults::finished(const Plan& plan, const PlanPlace& place) const {
  std::unordered_set<std::string> found;
  std::unordered_map<std::string, common::Json> presets;  // a few, of a great many cells
  for (const Cell& cell : plan.cells) {                   // each after those it needs
    const auto record = common::find_artefact<CellRecord>(record_file(cell.id));
    if (!record) continue;
    const auto [preset, first] = presets.try_emplace(cell.config);
    if (first) preset->second = preset_of(place, cell);
    if (!is_record_of(*record, plan, cell, preset->second)) continue;
    bool holds = true;
    for (const std::string& need : cell.needs()) holds = holds && found.count(need) > 0;
    if (holds) found.insert(cell.id);
  }
  return found;
}

std::int64_t KeptResults::changed(const Plan& plan) const {
  if (!holds_plan(folder_)) return 0;
  const Plan kept = find_plan(folder_);
  std::unordered_map<std::string, const Cell*> by_id;
  for (const Cell& cell : kept.cells) by_id.emplace(cell.id, &cell);
  return std::count_if(plan.cells.begin(), plan.cells.end(), [&](const Cell& cell) {
    const auto before = by_id.find(cell.id);
    return before != by_id.end() && before->second->settings != cell.settings &&
           fs::exists(record_file(cell.id));
  });
}

void KeptResults::keep(const Plan& plan, const PlanPlace& place) {
  if (!filed_) {
    check_same_plan(folder_, plan);
    write_plan(plan, folder_);
    filed_ = finished(plan, place);
  }
  for (const Cell& cell : plan.cells) {
    if (filed_->count(cell.id) > 0 || !finished_in(cell_folder(plan, place, cell.id))) continue;
    const CellRecord record = record_of(plan, place, cell);
    const std::string config = cell_folder(plan, place, cell.id) + "/config.json";
    if (!is_run_of(common::read_json_if_there(config), cell, record.preset)) continue;
    fs::remove_all(weights_folder(cell.id));  // of what it was before
    common::make_folders(fs::path(record_file(cell.id)).parent_path().string());
    common::write_file_atomically(record_file(cell.id), common::artefact_to_json(record).dump() + "\n");
    filed_->insert(cell.id);
  }
  const std::unordered_set<std::string> wanted = needed(plan, *filed_);
  for (const Cell& cell : plan.cells) {
    const std::string kept = weights_folder(cell.id), run = cell_folder(plan, place, cell.id);
    if (filed_->count(cell.id) == 0) continue;
    const bool recording = fs::exists(kept + "/" + kRecording) || fs::exists(run + "/" + kRecording);
    if (wanted.count(cell.id) == 0 && !recording) {
      if (fs::exists(kept)) remove_with_empty_parents(kept, folder_ + "/weights");
    } else if (!fs::exists(kept) && finished_in(run)) {
      common::make_folders(fs::path(kept).parent_path().string());
      copy_needed(run, kept);
    }
  }
}

void KeptResults::restore(const Plan& plan, const PlanPlace& place) const {
  const std::unordered_set<std::string> hold = filed_ ? *filed_ : finished(plan, place);
  for (const std::string& id : needed(plan, hold)) {
    const std::string run = cell_folder(plan, place, id);
    if (hold.count(id) == 0 || fs::exists(run) || !finished_in(weights_folder(id))) continue;
    common::make_folders(fs::path(run).parent_path().string());
    copy_needed(weights_folder(id), run);
  }
}

KeptPlan read_kept_plan(const std::string& folder) {
  KeptPlan kept;
  kept.plan = find_plan(folder);
  for (const Cell& cell : kept.plan.cells) {
    const std::string file = folder + "/records/" + cell.id + ".json";
    auto record = common::find_artefact<CellRecord>(file);
    if (record) check_curve(*record, file);
    if (!record || !is_record_of(*record, kept.plan, cell, record->preset)) continue;
    const std::vector<std::string> needs = cell.needs();
    if (std::all_of(needs.begin(), needs.end(),
                    [&](const std::string& id) { return kept.records.count(id) > 0; }))
      kept.records.emplace(cell.id, std::move(*record));
  }
  return kept;
}

}  // namespace lodestone::runs
