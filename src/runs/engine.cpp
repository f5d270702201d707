#include "lodestone/runs/engine.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <set>
#include <sstream>
#include <thread>
#include <unordered_map>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/progress.h"
#include "lodestone/runs/cell_record.h"
#include "lodestone/runs/kept_results.h"
#include "lodestone/runs/open_cells.h"

namespace lodestone::runs {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kBetweenLooks{2};
constexpr int kMostOfTime = 10;  // a look that takes long, at a great many cells, is followed by a rest
constexpr int kMostRunning = 8;  // named at a time

constexpr const char* kStopFile = "/stop";

/// What is known of the cells while they run.
class Watch {
 public:
  Watch(const Plan& plan, const PlanPlace& place, std::vector<const Cell*> wanted, const std::string& label)
      : plan_(plan),
        place_(place),
        all_(static_cast<std::int64_t>(wanted.size())),
        left_(unfinished_cells(plan, place, wanted)),
        results_(place.results),
        progress_(label, all_) {}

  /// Shows how far the cells are, and keeps what has been finished since; now and then.
  void look_sometimes() {
    if (Clock::now() < next_look_) return;
    const Clock::time_point begin = Clock::now();
    look();
    const auto rest = std::max<Clock::duration>(kBetweenLooks, kMostOfTime * (Clock::now() - begin));
    next_look_ = Clock::now() + rest;
  }
  void finish() {
    look();
    progress_.finish();
    keep();
  }
  const std::vector<const Cell*>& left() const { return left_; }
  std::int64_t all() const { return all_; }

 private:
  void look() {
    std::string running;
    int count = 0;
    const std::size_t before = left_.size();
    left_.erase(std::remove_if(left_.begin(), left_.end(),
                               [&](const Cell* cell) { return finished(*cell, running, count); }),
                left_.end());
    if (left_.size() < before) keep();
    if (count > kMostRunning) running += ", and " + std::to_string(count - kMostRunning) + " more";
    progress_.update(all_ - static_cast<std::int64_t>(left_.size()), running);
  }
  void keep() {
    if (!place_.results.empty()) results_.keep(plan_, place_);
  }
  /// Otherwise it is told where it is running.
  bool finished(const Cell& cell, std::string& running, int& count) const {
    const std::string folder = cell_folder(plan_, place_, cell.id);
    const std::optional<RunState> state = find_run(folder);
    if (state && state->finished) return true;
    if (!state || !is_running(folder) || ++count > kMostRunning) return false;
    running += (running.empty() ? "" : ", ") + cell.id;
    if (state->total > 0) running += " " + std::to_string(100 * state->done / state->total) + " %";
    return false;
  }

  const Plan& plan_;
  const PlanPlace& place_;
  std::int64_t all_;
  std::vector<const Cell*> left_;
  KeptResults results_;
  common::Progress progress_;
  Clock::time_point next_look_{};
};

bool is_same_work(const Cell& a, const Cell& b) {
  return a.verb == b.verb && a.config == b.config && a.settings == b.settings && a.seed == b.seed &&
         a.seed_offset == b.seed_offset;
}

/// What went wrong, in one line.
std::string failure(const Plan& plan, const PlanPlace& place, const Watch& watch) {
  std::set<std::string> left;
  for (const Cell* cell : watch.left()) left.insert(cell->id);
  const Cell* failed = nullptr;
  std::size_t waiting = 0;
  for (const Cell* cell : watch.left()) {
    const std::vector<std::string> needs = cell->needs();
    const bool waits =
        std::any_of(needs.begin(), needs.end(), [&](const std::string& id) { return left.count(id) > 0; });
    if (waits)
      ++waiting;
    else if (failed == nullptr)
      failed = cell;
  }
  std::string text =
      std::to_string(left.size()) + " of " + std::to_string(watch.all()) + " cells are not finished";
  if (waiting > 0) text += ", " + std::to_string(waiting) + " of them because they wait for others";
  if (failed == nullptr) return text;
  const std::string log = log_file(plan, place, failed->id);
  return text + "; the first, " + failed->id + ": " + last_said(log) + " (" + log + ")";
}

/// Whether a finished run is that of a cell which the folder's last plan did not have: one before it may
/// have.
bool is_run_of_cell(const std::string& folder, const RunState& state, const Plan& plan,
                    const PlanPlace& place, const Cell& cell) {
  const common::Json config = common::read_json_if_there(folder + "/config.json");
  const common::Json manifest = common::read_json_if_there(folder + "/manifest.json");
  return state.verb == cell.verb && manifest.is_object() &&
         manifest.value("seed", common::Json()) == cell.seed.value_or(plan.seed) + cell.seed_offset &&
         is_run_of(config, cell, preset_of(place, cell));
}

/// A cell that has not finished may be corrected, and others may come and go; what has finished stays what it
/// was.
void check_finished_cells(const Plan& plan, const PlanPlace& place) {
  if (!holds_plan(place.folder)) return;
  const Plan before = find_plan(place.folder);
  std::unordered_map<std::string, const Cell*> by_id;
  for (const Cell& cell : before.cells) by_id.emplace(cell.id, &cell);
  for (const Cell& cell : plan.cells) {
    const auto old = by_id.find(cell.id);
    if (old != by_id.end() && is_same_work(*old->second, cell)) continue;
    const std::string folder = cell_folder(plan, place, cell.id);
    const auto state = find_run(folder);
    if (!state || !state->finished) continue;
    if (old != by_id.end() || !is_run_of_cell(folder, *state, plan, place, cell))
      throw common::ConfigError(
          place.folder + ": the cell " + cell.id +
          " has finished with other settings: give it another id, or name another --out");
  }
}

}  // namespace

std::string log_file(const Plan& plan, const PlanPlace& place, const std::string& id) {
  return cell_folder(plan, place, id) + ".log";
}

bool asked_to_stop(const std::string& folder) { return fs::exists(folder + kStopFile); }

void ask_to_stop(const std::string& folder) { common::write_file_atomically(folder + kStopFile, ""); }

void run_plan(const Plan& plan, const PlanPlace& place, Engine& engine, const std::string& label,
              const std::string& only) {
  plan.validate();
  const std::vector<const Cell*> wanted = wanted_cells(plan, only);
  common::make_folders(place.folder);
  write_plan(plan, place.folder);
  if (!place.results.empty()) {
    KeptResults results(place.results);
    results.keep(plan, place);
    results.restore(plan, place);
  }
  common::remove_file(place.folder + kStopFile);  // it was meant for an earlier command
  const std::vector<const Cell*> cells = cells_to_run(plan, place, wanted);
  if (cells.empty()) return;
  for (const Cell* cell : cells)
    common::make_folders(fs::path(log_file(plan, place, cell->id)).parent_path().string());
  engine.start(plan, place, cells);
  Watch watch(plan, place, wanted, label);
  bool stopping = false;
  while (!engine.ended()) {
    const bool stop = common::interrupted() || asked_to_stop(place.folder);
    if (stop && !std::exchange(stopping, true)) engine.stop();
    watch.look_sometimes();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  watch.finish();
  // The engine may have ended by the same signal before anybody looked.
  const bool asked = common::interrupted() || asked_to_stop(place.folder);
  stopping = stopping || (asked && !watch.left().empty());
  if (stopping) {
    common::remove_file(place.folder + kStopFile);
    throw common::Interrupted(label + ": stopped; the same command goes on where it was");
  }
  if (!watch.left().empty()) throw common::Error(label + ": " + failure(plan, place, watch));
}

void run_plan_in_folder(const Plan& plan, const PlanPlace& place, Engine& engine, const std::string& verb,
                        common::Json settings, const std::string& only, const std::function<void()>& prepare,
                        std::map<std::string, std::string> inputs,
                        const std::vector<std::string>& free_keys) {
  plan.validate();
  wanted_cells(plan, only);
  settings["rig_file"] = place.rig_file;
  RunRequest request{place.folder, verb, settings, plan.seed, /*resume=*/true};
  // Score: what is told of the runs, not what is run. Cells (of a plan that a user wrote): see
  // check_finished_cells().
  request.free_keys = {"threads", "score", "lower_is_better", "cells"};
  request.free_keys.insert(request.free_keys.end(), free_keys.begin(), free_keys.end());
  request.inputs = std::move(inputs);
  if (!place.rig_file.empty()) request.inputs["--rig"] = place.rig_file;
  for (const Cell& cell : plan.cells)
    if (!cell.config.empty()) request.inputs["preset " + cell.config] = preset_file(place, cell);
  RunFolder run(std::move(request));
  if (settings.contains("cells")) check_finished_cells(plan, place);
  run.begin();
  prepare();
  run_plan(plan, place, engine, verb, only);
  if (unfinished_cells(plan, place, wanted_cells(plan)).empty()) run.finish();
}

}  // namespace lodestone::runs
