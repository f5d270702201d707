#include "lodestone/experiments/adaptation.h"

#include <cmath>
#include <filesystem>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/statistics.h"

namespace lodestone::experiments {
namespace {

namespace fs = std::filesystem;
using control::SeenPulse;

constexpr const char* kModel = "/model";
constexpr const char* kBefore = "/model_before";

/// The pulses of an episode that had current.
std::vector<SeenPulse> pulses_of(const data::Episode& episode, const data::RowLayout& rows) {
  const auto size = static_cast<std::size_t>(data::state_size(rows.state));
  const auto numbers = static_cast<std::size_t>(rows.action_size);
  const auto pose = [&](std::size_t row) {
    const double* state = &episode.observations[row * size];
    return geometry::Pose2{state[0], state[1], size == 3 ? state[2] : 0.0};
  };
  std::vector<SeenPulse> pulses;
  for (std::size_t t = 0; t < static_cast<std::size_t>(episode.length()); ++t) {
    if (episode.zero_current[t] != 0) continue;
    const double* drive = &episode.actions[numbers * t];
    pulses.push_back({pose(t), geometry::as_drive(drive, rows.action_size), pose(t + 1)});
  }
  return pulses;
}

double mean_of(const std::vector<std::vector<double>>& rows) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const std::vector<double>& row : rows) {
    for (const double value : row) sum += value;
    count += row.size();
  }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

/// Of every episode, the mean difference of its pulses.
std::vector<double> differences(const std::vector<std::vector<double>>& after,
                                const std::vector<std::vector<double>>& before) {
  std::vector<double> means;
  for (std::size_t i = 0; i < after.size(); ++i)
    means.push_back(common::mean(after[i]) - common::mean(before[i]));
  return means;
}

/// A copy of a checkpoint, with how it is deployed, swapped in whole.
void put(const std::string& run, const std::string& name, const std::string& model) {
  const std::string staged = run + name + ".tmp";
  fs::remove_all(staged);
  common::make_folders(staged);
  common::write_json(staged + "/deploy.json", {{"task", "all"}, {"controller", "planner"}});
  for (const fs::directory_entry& entry : fs::directory_iterator(model))
    if (entry.is_regular_file())
      common::write_file_atomically(staged + "/" + entry.path().filename().string(),
                                    common::read_file(entry.path()));
  common::replace_folder(staged, run + name);
}

}  // namespace

task::DriveGain identify(const SimulatorSource& simulator, const control::IdentificationConfig& config,
                         const data::Dataset& recorded) {
  control::IdentificationConfig everywhere = config;
  everywhere.place_sigma = 0.0;  // one gain for the whole rig
  control::GainFilter filter(motion_model(simulator, config), everywhere);
  for (const data::Episode& episode : recorded.episodes)
    for (const SeenPulse& pulse : pulses_of(episode, recorded.info.rows())) filter.learn(pulse);
  task::DriveGain gain = filter.gain();
  const double step = std::log(control::GainFilter::kMostGain) / control::GainFilter::kSteps;
  gain.log_sigma = std::hypot(gain.log_sigma, step / std::sqrt(12.0));  // no finer than gains are told apart
  return gain;
}

std::vector<std::vector<double>> explain(const SimulatorSource& simulator,
                                         const control::IdentificationConfig& config,
                                         const data::Dataset& recorded, double log_drive_gain) {
  control::MotionModel model = motion_model(simulator, config);
  std::vector<std::vector<double>> rows;
  for (const data::Episode& episode : recorded.episodes) {
    std::vector<SeenPulse> pulses = pulses_of(episode, recorded.info.rows());
    if (pulses.empty()) continue;
    for (SeenPulse& pulse : pulses) pulse.drive_A *= std::exp(log_drive_gain);
    model.judge(pulses, rows.emplace_back());
    for (double& ratio : rows.back()) ratio = std::log(ratio);
  }
  return rows;
}

runs::Adaptation compare(const SimulatorSource* before, const SimulatorSource& after,
                         const control::IdentificationConfig& config, const data::Dataset& learned_from,
                         const data::Dataset& held_back) {
  runs::Adaptation result;
  const auto rows = explain(after, config, held_back, 0.0);
  for (const std::vector<double>& row : rows) result.held_back += static_cast<std::int64_t>(row.size());
  result.log_likelihood = mean_of(rows);
  if (before == nullptr) return result;
  const task::DriveGain gain = identify(*before, config, learned_from);
  const auto corrected = explain(*before, config, held_back, gain.log_mean);
  result.log_drive_gain = gain.log_mean;
  result.log_drive_gain_sigma = gain.log_sigma;
  result.log_likelihood_before = mean_of(explain(*before, config, held_back, 0.0));
  result.log_likelihood_with_gain = mean_of(corrected);
  const std::vector<double> better = differences(rows, corrected);
  const common::Interval interval =
      common::bootstrap_interval({better}, common::mean, common::RandomStream(1, "adaptation"));
  result.better_by = common::mean(better);
  result.better_by_low = interval.low;
  result.better_by_high = interval.high;
  result.kept = interval.low > 0.0;
  return result;
}

void put_model(const std::string& run, const std::string& model) { put(run, kModel, model); }

void keep_before(const std::string& run, const std::string& model) { put(run, kBefore, model); }

void roll_back(const std::string& run) {
  const std::string file = run + "/" + runs::Adaptation::kFile;
  if (!fs::exists(file))
    throw common::ConfigError("--rollback: " + run + " holds no adaptation that has ended");
  auto result = common::read_artefact<runs::Adaptation>(file);
  if (!fs::exists(run + kBefore))
    throw common::ConfigError(
        "--rollback: nothing to take back in " + run +
        ": it began from nothing, kept the simulator as it was, or was taken back already");
  put(run, kModel, run + kBefore);  // a copy, so that a kill leaves something to repeat
  result.rolled_back = true;
  common::write_artefact(file, result);
  fs::remove_all(run + kBefore);
}

}  // namespace lodestone::experiments
