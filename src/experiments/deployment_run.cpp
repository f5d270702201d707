#include "lodestone/experiments/deployment_run.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <utility>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/experiments/routing.h"
#include "lodestone/experiments/suture.h"

namespace lodestone::experiments {
namespace {

constexpr const char* kJournal = "/trials.jsonl";
constexpr const char* kTrajectories = "/trajectories.csv";

void check(const std::ostream& out, const std::string& path) {
  if (!out) throw common::IoError("cannot write " + path + ": " + std::strerror(errno));
}

/// Long deployments need no memory for them.
void forget_trajectories(runs::TrialRecord& record) {
  record.trajectory.reset();
  record.sensed_trajectory.clear();
  record.reference_mm.reset();
  record.reference_heading_rad.reset();
  record.approach.reset();
  record.route_mm.reset();
  record.told_zones.reset();
  record.time_s.clear();
}

}  // namespace

DeploymentRun::DeploymentRun(const DeploymentConfig& config, const DeploymentJob& job, std::string folder,
                             TrialDriver driver)
    : config_(config), job_(job), folder_(std::move(folder)), driver_(std::move(driver)) {
  for (std::size_t rig = 0; rig < job.rigs.size(); ++rig)
    for (std::size_t source = 0; source < job.sources.size(); ++source)
      for (std::size_t task = 0; task < job.tasks.size(); ++task) parts_.push_back({rig, source, task, {}});
  for (std::size_t rig = 0; rig < job.rigs.size(); ++rig) common::make_folders(folder_of(rig));
}

runs::Progress DeploymentRun::progress() const {
  const std::int64_t total = static_cast<std::int64_t>(parts_.size()) * config_.trials.count;
  return {done_, total, done_ >= total || !driver_.stopped().empty(), note_};
}

void DeploymentRun::step(common::MetricsLog& /*metrics*/) {
  if (!recorder_) {
    // A kill before the run's first checkpoint: trials that have ended are kept nevertheless.
    if (done_ == 0) load(folder_);
    // What was written at a stop is not all of them.
    for (std::size_t rig = 0; rig < job_.rigs.size(); ++rig)
      common::remove_file(folder_of(rig) + "/" + runs::kTrialsFile);
    if (progress().finished) return;
    std::vector<std::string> coils = {"px", "mx", "py", "my"};
    if (const auto& each = config_.rig.coils.each; !each.empty()) {
      coils.clear();
      for (const physics::CoilDescription& coil : each) coils.push_back(coil.name);
    }
    recorder_.emplace(folder_ + kTrajectories, job_.rigs.front() != RigKind::kReal, rows_, coils,
                      config_.rig.drive_size());
    journal_.open(folder_ + kJournal, std::ios::app);
    check(journal_, folder_ + kJournal);
  }
  const auto part = std::find_if(parts_.begin(), parts_.end(), [this](const Part& p) {
    return static_cast<std::int64_t>(p.ended.size()) < config_.trials.count;
  });
  const ControllerSource& source = job_.sources[part->source];
  note_ = source.name + " " + job_.tasks[part->task];
  const std::vector<TrialResult> results = drive(*part, source);
  if (common::interrupted()) throw common::Interrupted("trials were cut short");
  for (const TrialResult& result : results) recorder_->write(result, std::exchange(live_rows_, 0));
  recorder_->sync();  // before the journal that names its rows
  for (const TrialResult& result : results) keep(*part, result);
  common::sync_path(folder_ + kJournal);
}

std::vector<TrialResult> DeploymentRun::drive(const Part& part, const ControllerSource& source) {
  const RigKind rig = job_.rigs[part.rig];
  std::vector<TrialPlan> plans = next_plans(part);
  for (TrialPlan& plan : plans) plan.aims = aims_for(part.source, plan.stitches);
  live_rows_ = 0;
  return driver_.drive(plans, rig, source, [&](const TrialSample& sample) {
    recorder_->write(plans.front(), to_string(rig), source.name, sample);
    ++live_rows_;
  });
}

const std::vector<geometry::Stitch>& DeploymentRun::aims_for(std::size_t source,
                                                             const std::vector<geometry::Stitch>& stitches) {
  const auto known = aims_.find(source);
  if (known != aims_.end() || stitches.empty()) return known == aims_.end() ? stitches : known->second;
  return aims_[source] = aims_of(config_, job_.sources[source], stitches);
}

std::vector<TrialPlan> DeploymentRun::next_plans(const Part& part) const {
  const auto first = static_cast<std::int64_t>(part.ended.size());
  const std::int64_t last = std::min(first + static_cast<std::int64_t>(driver_.batch), config_.trials.count);
  std::vector<TrialPlan> plans;
  for (std::int64_t index = first; index < last; ++index)
    plans.push_back(plan_trial(config_, job_.tasks[part.task], index, job_.target_m, job_.path, driver_.fits,
                               job_.region ? &*job_.region : nullptr, job_.routes));
  return plans;
}

void DeploymentRun::keep(Part& part, const TrialResult& result) {
  runs::TrialRecord record = record_of(result);
  journal_ << common::artefact_to_json(record).dump() << std::endl;
  check(journal_, folder_ + kJournal);
  if (!record.completed)
    common::log_warning("trial " + std::to_string(record.trial) + " of " + record.task +
                        " stopped early: " + record.stop_reason);
  rows_ += static_cast<std::int64_t>(record.time_s.size());
  ++done_;
  forget_trajectories(record);
  part.ended.push_back(std::move(record));
}

void DeploymentRun::save(const std::string& folder) {
  if (done_ == 0 && driver_.stopped().empty()) return;
  for (std::size_t rig = 0; rig < job_.rigs.size() && job_.rigs.size() > 1; ++rig)
    common::write_artefact(folder_of(rig) + "/" + runs::DeploymentSummary::kFile, summary_of(rig));
  common::write_artefact(folder + "/" + runs::DeploymentSummary::kFile, summary());
}

void DeploymentRun::load(const std::string& folder) {
  const std::string path = folder + kJournal;
  std::istringstream lines(std::filesystem::exists(path) ? common::read_file(path) : "");
  std::string whole;
  for (std::string line;
       std::getline(lines, line) && !lines.eof();) {  // a line without its end was cut by a kill
    auto record = common::artefact_from_json<runs::TrialRecord>(common::parse_json(line, path), path);
    rows_ += static_cast<std::int64_t>(record.time_s.size());
    forget_trajectories(record);
    Part& part = part_of(record);
    part.ended.push_back(std::move(record));
    ++done_;
    whole += line + "\n";
  }
  common::write_file_atomically(path, whole);
}

DeploymentRun::Part& DeploymentRun::part_of(const runs::TrialRecord& record) {
  for (Part& part : parts_)
    if (to_string(job_.rigs[part.rig]) == record.rig && job_.sources[part.source].name == record.controller &&
        job_.tasks[part.task] == record.task && static_cast<std::int64_t>(part.ended.size()) == record.trial)
      return part;
  throw common::DataError(folder_ + kJournal + ": trial " + std::to_string(record.trial) + " of " +
                          record.task + " by " + record.controller +
                          " does not belong to this run; start again in another folder");
}

runs::RigSummary DeploymentRun::summary_of(std::size_t rig) const {
  runs::RigSummary summary;
  for (const Part& part : parts_) {
    if (part.rig != rig) continue;
    const std::string& controller = job_.sources[part.source].name;
    const bool baseline = controller == "baseline";
    if (baseline && !summary.baseline) summary.baseline.emplace();
    if (!baseline) summary.controller = controller;
    if (part.ended.empty()) continue;
    runs::TaskTable& table = baseline ? *summary.baseline : summary.tasks;
    table.by_task[job_.tasks[part.task]] = summarise_task(part.ended);
  }
  return summary;
}

runs::DeploymentSummary DeploymentRun::summary() const {
  runs::DeploymentSummary summary;
  // At the top stands the explored rig when both are driven.
  static_cast<runs::RigSummary&>(summary) = summary_of(0);
  for (std::size_t rig = 0; rig < job_.rigs.size() && job_.rigs.size() > 1; ++rig)
    summary.by_rig[to_string(job_.rigs[rig])] = summary_of(rig);
  if (job_.rigs.front() == RigKind::kReal) summary.scored_by = "camera";
  if (const std::string reason = driver_.stopped(); !reason.empty()) summary.stopped = reason;
  summary.provenance = job_.provenance;
  return summary;
}

void DeploymentRun::write_trials() const {
  if (job_.routes) common::write_artefact(folder_ + "/" + runs::ReachMap::kFile, reach_map_of(*job_.routes));
  std::ifstream lines(folder_ + kJournal);
  std::vector<std::ofstream> out;
  for (std::size_t rig = 0; rig < job_.rigs.size(); ++rig)
    out.emplace_back(folder_of(rig) + "/trials.json.part");
  std::vector<std::string> before(out.size(), "[\n");
  // The journal is in the order of the parts.
  for (const Part& part : parts_) {
    std::string line;
    for (std::size_t trial = 0; trial < part.ended.size() && std::getline(lines, line); ++trial)
      out[part.rig] << std::exchange(before[part.rig], ",\n") << line;
  }
  for (std::size_t rig = 0; rig < out.size(); ++rig) {
    out[rig] << (before[rig] == "[\n" ? "[]\n" : "\n]\n");
    out[rig].close();
    check(out[rig], folder_of(rig) + "/" + runs::kTrialsFile);
    common::replace_file(folder_of(rig) + "/trials.json.part", folder_of(rig) + "/" + runs::kTrialsFile);
  }
}

std::string DeploymentRun::folder_of(std::size_t rig) const {
  return job_.rigs.size() > 1 ? folder_ + "/" + to_string(job_.rigs[rig]) : folder_;
}

}  // namespace lodestone::experiments
