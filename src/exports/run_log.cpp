#include "lodestone/exports/run_log.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <opencv2/videoio.hpp>
#include <optional>
#include <sstream>
#include <utility>

#include "lodestone/common/artefact.h"
#include "lodestone/common/csv_table.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/data/journal.h"
#include "lodestone/exports/recording_log.h"
#include "lodestone/exports/rig_log.h"
#include "lodestone/imaging/image_file.h"
#include "lodestone/runs/deployment_results.h"

namespace lodestone::exports {
namespace {

constexpr std::uint64_t kSecond_ns = 1'000'000'000;
constexpr const char* kTrajectories = "/trajectories.csv";

/// Rig, controller, task and number of a trial.
struct TrialKey {
  std::string rig, controller, task;
  std::int64_t trial = 0;

  std::string name() const { return rig + "-" + controller + "-" + task + "-" + std::to_string(trial); }
  bool operator<(const TrialKey& other) const { return name() < other.name(); }
  bool operator!=(const TrialKey& other) const { return name() != other.name(); }
};

using Trials = std::map<TrialKey, runs::TrialRecord>;

void add(Trials& trials, runs::TrialRecord record) {
  const TrialKey key{record.rig, record.controller, record.task, record.trial};
  trials.emplace(key, std::move(record));
}

/// The trials that have ended, as the run's results or, where it was cut off, its journal have them.
Trials trials_of(const std::string& run) {
  Trials trials;
  for (const char* part : {"", "/explored", "/unseen"})
    if (auto found = runs::find_trials(run + part))
      for (runs::TrialRecord& record : *found) add(trials, std::move(record));
  const std::string journal = run + "/trials.jsonl";
  if (!trials.empty() || !std::filesystem::exists(journal)) return trials;
  std::istringstream lines(common::read_file(journal));
  for (std::string line; std::getline(lines, line) && !lines.eof();)  // the last line may be cut
    add(trials, common::artefact_from_json<runs::TrialRecord>(common::parse_json(line, journal), journal));
  return trials;
}

/// The rows of a trajectories.csv one by one; columns that older versions did not write are absent.
class Trajectories {
 public:
  explicit Trajectories(const std::string& path) : table_(path) {}

  bool next() { return table_.next(); }
  TrialKey key() const {
    table_.check_width();
    return {text("rig"), text("controller"), text("task"), std::llround(*number("trial"))};
  }
  double time_s() const { return *number("t_s"); }
  LoggedStep step() const;

 private:
  std::string text(const std::string& column) const { return table_.text(table_.column(column)); }
  std::optional<double> number(const std::string& column) const {
    if (!table_.has_columns({column}) || text(column).empty()) return std::nullopt;
    return table_.number(table_.column(column));
  }
  std::optional<geometry::Pose2> pose(const std::string& of) const {
    const auto x_m = number(of + "_x_m");
    const auto y_m = number(of + "_y_m");
    if (!x_m || !y_m) return std::nullopt;
    return geometry::Pose2{*x_m, *y_m, number(of + "_heading_rad").value_or(0.0)};
  }
  common::CsvTable table_;
};

LoggedStep Trajectories::step() const {
  LoggedStep step;
  step.sensed = pose("sensed");
  step.truth = pose("true");
  step.target = pose("target");
  OfCoils current_A;
  for (const std::string& column : table_.header()) {
    const bool of_coil = column.rfind("current_", 0) == 0 && column.size() > 2 &&
                         column.compare(column.size() - 2, 2, "_A") == 0;
    if (const auto value = of_coil ? number(column) : std::nullopt) current_A.push_back(*value);
  }
  if (!current_A.empty()) step.current_A = current_A;
  StepFacts& facts = step.facts;
  facts.sensed = step.sensed.has_value();
  if (!facts.sensed) facts.reason = "none was found";
  if (step.sensed && step.target)
    facts.error_m = (step.sensed->position_m() - step.target->position_m()).norm();
  for (const std::string& column : table_.header())
    if (const auto value = column.rfind("action_", 0) == 0 ? number(column) : std::nullopt)
      facts.action.push_back(*value);
  facts.log_drive_gain = number("log_drive_gain");
  facts.log_drive_gain_sigma = number("log_drive_gain_sigma");
  facts.rig_changed = number("rig_changed").value_or(0.0) != 0.0;
  return step;
}

/// The images of a trial's film, one for each of its samples; none where it was not filmed.
class Film {
 public:
  Film(const std::string& run, const TrialKey& key) {
    const std::string file = run + "/videos/" + key.name() + ".mp4";
    if (std::filesystem::exists(file)) video_.open(file, cv::CAP_FFMPEG);
  }
  /// As JPEG; empty after the last.
  std::string next() {
    cv::Mat image;
    if (!video_.isOpened() || !video_.read(image)) return "";
    return imaging::encoded_image(image, ".jpg");
  }

 private:
  cv::VideoCapture video_;
};

/// Trials one after another in one log.
class RunLog {
 public:
  RunLog(const std::string& run, const std::string& file, const std::map<std::string, std::string>& facts)
      : run_(run), trials_(trials_of(run)), log_(file, facts) {}

  /// All trials of a file of trajectories; `cut_short`: none of them has ended.
  void add(const std::string& trajectories, bool cut_short) {
    Trajectories rows(trajectories);
    std::optional<TrialKey> trial;
    while (rows.next()) {
      const TrialKey key = rows.key();
      // One that was cut short twice begins anew.
      if (!trial || *trial != key || rows.time_s() < time_s_) {
        end();
        begin(key, cut_short);
        trial = key;
      }
      add_step(rows);
    }
    end();
  }
  RunLogFacts finish() {
    log_.finish();
    return facts_;
  }

 private:
  void begin(const TrialKey& key, bool cut_short) {
    if (facts_.trials++ > 0) start_ns_ = now_ns_ + kSecond_ns;
    now_ns_ = start_ns_;
    sample_ = 0;
    time_s_ = 0.0;
    const auto found = trials_.find(key);
    record_ = found == trials_.end() || cut_short ? nullptr : &found->second;
    film_ = cut_short ? nullptr : std::make_unique<Film>(run_, key);
    in_trial_ = true;
    log_.event(start_ns_, LogLevel::kInfo, "trial " + key.name());
  }

  void add_step(const Trajectories& rows) {
    time_s_ = rows.time_s();
    LoggedStep step = rows.step();
    step.time_ns = now_ns_ =
        start_ns_ + static_cast<std::uint64_t>(std::llround(1e9 * std::max(0.0, time_s_)));
    if (record_ != nullptr && step.target) step.target->heading_rad = target_heading_rad();
    if (record_ != nullptr && record_->temperature_C && sample_ < record_->temperature_C->size())
      if (const auto& temperature_C = (*record_->temperature_C)[sample_])
        step.reading.emplace().temperature_C = temperature_C;
    const std::string image = film_ ? film_->next() : "";
    if (!image.empty()) {
      log_.image(now_ns_, now_ns_, image);
      ++facts_.images;
    }
    log_.step(step);
    ++sample_;
    ++facts_.steps;
  }

  /// At this sample; 0 where any will do.
  double target_heading_rad() const {
    const auto& along_path_rad = record_->reference_heading_rad;
    if (along_path_rad && sample_ < along_path_rad->size()) return (*along_path_rad)[sample_];
    return record_->target_heading_rad.value_or(0.0);
  }

  void end() {
    if (!std::exchange(in_trial_, false)) return;
    if (record_ == nullptr)
      log_.event(now_ns_, LogLevel::kWarning, "the trial was cut short");
    else
      log_.event(now_ns_, record_->completed ? LogLevel::kInfo : LogLevel::kError,
                 record_->completed ? "the trial has ended" : "stopped: " + record_->stop_reason);
  }

  std::string run_;
  Trials trials_;
  RigLog log_;
  RunLogFacts facts_;
  std::uint64_t start_ns_ = 0, now_ns_ = 0;
  // Of the trial.
  bool in_trial_ = false;
  double time_s_ = 0.0;
  std::size_t sample_ = 0;
  const runs::TrialRecord* record_ = nullptr;
  std::unique_ptr<Film> film_;
};

/// What the run says of itself.
std::map<std::string, std::string> facts_of(const std::string& run) {
  std::map<std::string, std::string> facts;
  for (const char* name : {"config", "manifest"}) {
    const common::Json json = common::read_json_if_there(run + "/" + name + ".json");
    if (!json.is_null()) facts[name] = json.dump();
  }
  return facts;
}

RunLogFacts log_deployment(const std::string& run, const std::string& file) {
  RunLog log(run, file, facts_of(run));
  log.add(run + kTrajectories, false);
  const std::string cut_short = run + "/trajectories_cut_short.csv";
  if (std::filesystem::exists(cut_short)) log.add(cut_short, true);
  return log.finish();
}

RunLogFacts log_collection(const std::string& run, const std::string& recording, const std::string& file) {
  const data::Dataset dataset = data::read_dataset(recording);
  RigLog log(file, facts_of(run));
  RunLogFacts facts;
  facts.episodes = static_cast<std::int64_t>(dataset.episodes.size());
  facts.steps = log_recording(dataset, log);
  log.finish();
  return facts;
}

}  // namespace

RunLogFacts write_run_log(const std::string& run, const std::string& file) {
  const std::string recording = run + "/" + data::kRecordingFile;
  const bool driven = std::filesystem::exists(run + kTrajectories);
  if (!driven && !std::filesystem::exists(recording) &&
      !std::filesystem::exists(data::journal_beside(recording)))
    throw common::DataError(run + " holds neither trajectories.csv nor " + data::kRecordingFile +
                            ": name the folder of a run of deploy or collect");
  const std::string staged = file + ".part";
  try {
    const RunLogFacts facts = driven ? log_deployment(run, staged) : log_collection(run, recording, staged);
    common::replace_file(staged, file);
    return facts;
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(staged, ignored);
    throw;
  }
}

}  // namespace lodestone::exports
