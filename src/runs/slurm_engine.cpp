#include "lodestone/runs/slurm_engine.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <unordered_set>
#include <utility>

#include "lodestone/common/artefact.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/shell.h"

namespace lodestone::runs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLast = "last";  // comment of the job after all others
constexpr std::chrono::seconds kPollPeriod{5};
constexpr std::size_t kMostCancelled = 1000;  // by one command line

/// Cells of an array by the index of their task: KEY.json.
struct ArrayRecord {
  std::map<int, std::string> cells;

  template <class Visitor>
  void visit(Visitor& v) {
    v.field("cells", cells);
  }
};

/// A name that no other plan's jobs have, the same every time.
std::string name_in(const std::string& folder) {
  const std::string file = folder + "/name";
  if (!fs::exists(file)) {
    const std::string here = fs::absolute(folder).string() + common::utc_now() + std::to_string(::getpid());
    common::write_file_atomically(file, "lodestone-" + common::sha256(here).substr(0, 10));
  }
  return common::read_file(file);
}

int next_number(const std::string& folder) {
  int number = 1;
  while (fs::exists(folder + "/" + std::to_string(number) + ".json")) ++number;
  return number;
}

/// Tasks that are waiting or running, by the cell that they run.
std::map<std::string, QueuedTask> cells_of(const std::vector<QueuedTask>& queued, const std::string& folder) {
  std::map<std::string, ArrayRecord> records;
  std::map<std::string, QueuedTask> by_cell;
  for (const QueuedTask& task : queued) {
    if (task.comment == kLast) continue;
    auto record = records.find(task.comment);
    if (record == records.end())
      record = records
                   .emplace(task.comment,
                            common::read_artefact<ArrayRecord>(folder + "/" + task.comment + ".json"))
                   .first;
    const auto cell = record->second.cells.find(std::stoi(task.index));
    if (cell != record->second.cells.end()) by_cell[cell->second] = task;
  }
  return by_cell;
}

/// What one of its tasks waits for, of those that run already; where its own cell is just ending, for that.
std::vector<std::string> running_before(const SlurmArray& array,
                                        const std::map<std::string, QueuedTask>& running) {
  std::set<std::string> names;
  for (const SlurmTask& task : array.tasks) {
    std::vector<std::string> ids = task.cell->needs();
    ids.push_back(task.cell->id);
    for (const std::string& id : ids)
      if (const auto found = running.find(id); found != running.end()) names.insert(found->second.name());
  }
  return {names.begin(), names.end()};
}

void cancel(const std::vector<std::string>& names) {
  for (std::size_t first = 0; first < names.size(); first += kMostCancelled) {
    const auto begin = names.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end =
        names.begin() + static_cast<std::ptrdiff_t>(std::min(names.size(), first + kMostCancelled));
    std::vector<std::string> words = {"scancel"};
    words.insert(words.end(), begin, end);
    common::run_command(words);
  }
}

/// Cells that nobody runs or will run. Those that wait for one of them in vain are cancelled, and among them.
std::vector<const Cell*> to_submit(const std::vector<const Cell*>& cells,
                                   const std::map<std::string, QueuedTask>& running) {
  std::vector<const Cell*> missing;
  std::unordered_set<std::string> ids;
  std::vector<std::string> in_vain;
  for (const Cell* cell : cells) {  // each after those it needs
    const auto found = running.find(cell->id);
    const std::vector<std::string> needs = cell->needs();
    const bool waits_for_missing =
        std::any_of(needs.begin(), needs.end(), [&](const std::string& id) { return ids.count(id) > 0; });
    const bool queued = found != running.end() && !found->second.ending;
    if (queued && !(found->second.waiting && waits_for_missing)) continue;
    if (queued) in_vain.push_back(found->second.name());
    missing.push_back(cell);
    ids.insert(cell->id);
  }
  cancel(in_vain);
  return missing;
}

}  // namespace

bool cancel_left_jobs(const std::string& folder) {
  const std::string name = folder + "/slurm/name";
  if (!fs::exists(name)) return false;
  const common::CommandResult said = common::run_command({"scancel", "--name=" + common::read_file(name)});
  if (said.exit_code != 0)
    throw common::Error("Slurm does not cancel the jobs: " + said.output.substr(0, said.output.find('\n')));
  return true;
}

void SlurmEngine::start(const Plan& plan, const PlanPlace& place, const std::vector<const Cell*>& cells) {
  folder_ = place.folder + "/slurm";
  waiting_.clear();
  jobs_.clear();
  const std::int64_t most_tasks = most_array_tasks();
  common::make_folders(folder_);
  name_ = name_in(folder_);
  const auto queued = find_queued(name_, /*each_task=*/true);
  if (!queued) throw common::Error("Slurm does not say what is running: squeue fails");
  queued_before_ = !queued->empty();
  replaced_.clear();
  const std::map<std::string, QueuedTask> running = cells_of(*queued, folder_);
  const std::vector<const Cell*> missing = to_submit(cells, running);
  common::write_file_atomically(folder_ + "/task.sh", slurm_script(plan));
  prepare(plan, place, slurm_arrays(plan, place, missing, most_tasks), running);
  prepare_last(place, *queued);
  submit();
  looked_ = {};
}

void SlurmEngine::prepare(const Plan& plan, const PlanPlace& place, const std::vector<SlurmArray>& arrays,
                          const std::map<std::string, QueuedTask>& running) {
  const int first = next_number(folder_);
  const auto key = [first](std::size_t array) { return std::to_string(first + static_cast<int>(array)); };
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    const SlurmArray& array = arrays[i];
    const std::string tasks_file = folder_ + "/" + key(i) + ".tasks";
    Submission made{key(i), {}, array.one_to_one, {}, running_before(array, running)};
    made.words = {"--array=" + slurm_indices(array),
                  "--cpus-per-task=" + std::to_string(array.resources.cpus)};
    if (const auto memory_mb = array.resources.memory_mb)
      made.words.push_back("--mem=" + std::to_string(*memory_mb) + "M");
    if (const auto minutes = array.resources.minutes)
      made.words.push_back("--time=" + std::to_string(*minutes));
    made.words.insert(made.words.end(), {folder_ + "/task.sh", tasks_file});
    for (const std::size_t before : array.after) made.after.push_back(key(before));
    ArrayRecord record;
    for (const SlurmTask& task : array.tasks) record.cells[static_cast<int>(task.index)] = task.cell->id;
    common::write_file_atomically(tasks_file, slurm_lines(plan, place, array));
    common::write_artefact(folder_ + "/" + made.key + ".json", record);
    waiting_.push_back(std::move(made));
  }
}

/// Says how far the plan came, or what the verb has to say of it. One of an earlier process makes room.
void SlurmEngine::prepare_last(const PlanPlace& place, const std::vector<QueuedTask>& queued) {
  Submission last{kLast, {}, false, {}, {}};
  std::set<std::string> jobs;
  for (const QueuedTask& task : queued) {
    if (task.comment != kLast) {
      jobs.insert(task.job);
    } else if (waiting_.empty()) {
      return;
    } else {
      replaced_.push_back(task.job);
    }
  }
  std::vector<std::string> command = place.last_command;
  if (command.empty()) command = {"status", place.folder};
  command.insert(command.begin(), place.program);
  last.words = {"--mem=4096M", "--wrap=" + common::shell_quoted(command)};
  for (const Submission& array : waiting_) last.after.push_back(array.key);
  last.tasks.assign(jobs.begin(), jobs.end());
  waiting_.push_back(std::move(last));
}

std::string SlurmEngine::dependency(const Submission& submission) const {
  std::string text;
  const auto add = [&text](const char* kind, const std::vector<std::string>& names) {
    if (names.empty()) return;
    text += (text.empty() ? "--dependency=" : ",") + std::string(kind);
    for (const std::string& name : names) text += ":" + name;
  };
  std::vector<std::string> all = submission.tasks;
  std::vector<std::string> one_by_one;
  for (const std::string& key : submission.after)
    (submission.one_to_one ? one_by_one : all).push_back(jobs_.at(key));
  add("aftercorr", one_by_one);
  add("afterany", all);
  return text;
}

/// As many as the cluster takes now; the others are tried again at the next look.
void SlurmEngine::submit() {
  while (!waiting_.empty()) {
    const Submission& next = waiting_.front();
    std::vector<std::string> words = {
        "sbatch",
        "--parsable",
        "--job-name=" + name_,
        "--comment=" + next.key,
        "--open-mode=append",
        "--output=" + folder_ + (next.key == kLast ? "/last.log" : "/slurm.log")};
    if (const std::string before = dependency(next); !before.empty()) words.push_back(before);
    words.insert(words.end(), next.words.begin(), next.words.end());
    const common::CommandResult said = common::run_command(words);
    const std::string job = said.output.substr(0, said.output.find_first_not_of("0123456789"));
    if (said.exit_code != 0 || job.empty()) {
      refusal_ = said.output.substr(0, said.output.find('\n'));
      if (jobs_.empty() && !queued_before_)
        throw common::Error("Slurm does not take the first job: " + refusal_);
      return;
    }
    common::write_file_atomically(folder_ + "/" + next.key + ".job", job + "\n");
    jobs_[next.key] = job;
    if (next.key == kLast) cancel(std::exchange(replaced_, {}));
    waiting_.pop_front();
  }
}

bool SlurmEngine::ended() {
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_ < kPollPeriod) return false;
  looked_ = now;
  const auto queued = find_queued(name_, /*each_task=*/false);
  if (!queued) return false;
  if (waiting_.empty()) return queued->empty();
  submit();
  if (queued->empty() && !waiting_.empty())
    throw common::Error("Slurm takes no more jobs, though none is running: " + refusal_);
  return false;
}

void SlurmEngine::stop() {
  waiting_.clear();
  common::run_command({"scancel", "--name=" + name_});
}

}  // namespace lodestone::runs
