#include "lodestone/runs/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/common/statistics.h"
#include "lodestone/runs/run_folder.h"

namespace lodestone::runs {
namespace {

using common::ConfigError;
using common::Json;

/// A trial of both runs, and the unit that it belongs to.
struct Pair {
  const TrialRecord* first;
  const TrialRecord* other;
  std::int64_t unit;
};

using Figure = std::function<std::optional<double>(const TrialRecord&)>;

std::optional<double> error_mm(const TrialRecord& trial) { return trial.figures().error_mm(); }
std::optional<double> failed(const TrialRecord& trial) { return trial.figures().success ? 0.0 : 1.0; }
std::optional<double> stopped(const TrialRecord& trial) { return trial.completed ? 0.0 : 1.0; }
std::optional<double> completion(const TrialRecord& trial) { return trial.figures().completion; }
std::optional<double> seconds(const TrialRecord& trial) { return trial.figures().seconds_to_reach; }
std::optional<double> error_of_success_mm(const TrialRecord& trial) {
  return trial.figures().success ? error_mm(trial) : std::nullopt;
}

PairedFigure paired(const std::vector<Pair>& pairs, const Figure& figure) {
  struct Sum {
    double first = 0.0, other = 0.0, count = 0.0;
  };
  std::map<std::int64_t, Sum> units;
  PairedFigure result;
  for (const Pair& pair : pairs) {
    const std::optional<double> first = figure(*pair.first), other = figure(*pair.other);
    if (!first || !other) continue;
    Sum& sum = units[pair.unit];
    sum.first += *first;
    sum.other += *other;
    sum.count += 1.0;
    ++result.pairs;
  }
  std::vector<double> firsts, others, differences;
  for (const auto& [unit, sum] : units) {
    firsts.push_back(sum.first / sum.count);
    others.push_back(sum.other / sum.count);
    differences.push_back(others.back() - firsts.back());
  }
  result.units = static_cast<std::int64_t>(units.size());
  result.first = common::mean(firsts);
  result.other = common::mean(others);
  result.difference = common::mean(differences);
  const common::Interval interval =
      common::bootstrap_interval({differences}, common::mean, common::RandomStream(1, "compare"), 10000);
  result.interval = {interval.low, interval.high};
  result.signed_rank_p = common::signed_rank_p(differences);
  return result;
}

std::optional<PairedFigure> paired_if_any(const std::vector<Pair>& pairs, const Figure& figure) {
  PairedFigure result = paired(pairs, figure);
  return result.pairs > 0 ? std::optional(std::move(result)) : std::nullopt;
}

/// That which a path begins with, where it has headings.
std::optional<double> first_heading_rad(const TrialRecord& trial) {
  const auto& headings_rad = trial.reference_heading_rad;
  return headings_rad && !headings_rad->empty() ? std::optional(headings_rad->front()) : std::nullopt;
}

bool same_trial(const TrialRecord& a, const TrialRecord& b) {
  return a.start == b.start && a.target_mm == b.target_mm && a.target_heading_rad == b.target_heading_rad &&
         a.path_mm == b.path_mm && a.stitches == b.stitches && first_heading_rad(a) == first_heading_rad(b);
}

using Key = std::tuple<std::string, std::string, std::int64_t>;  // task, kind of rig, number

std::map<Key, const TrialRecord*> by_key(const ComparedRun& run) {
  std::map<Key, const TrialRecord*> trials;
  for (const TrialRecord& trial : run.trials) trials[{trial.task, trial.rig, trial.trial}] = &trial;
  return trials;
}

std::string counted(std::int64_t count, const char* word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

std::string scope(const ComparisonRow& row) {
  const std::string units =
      row.rigs_are_units ? counted(row.error_mm.units, "rig") + ", " + counted(row.error_mm.pairs, "trial")
                         : counted(row.error_mm.units, "trial");
  return units + (row.one_rig ? " on one rig" : "");
}

std::string about_errors(const ComparisonRow& row, const std::string& first, const std::string& other) {
  const PairedFigure& error = row.error_mm;
  if (!error.larger() && !error.smaller())
    return fmt::format(
        "the errors of {} and {} are not told apart ({:+.2f} mm, 95 %: {:+.2f} to {:+.2f}; p {:.2f})", other,
        first, error.difference, error.interval[0], error.interval[1], error.signed_rank_p);
  const double low = std::min(std::abs(error.interval[0]), std::abs(error.interval[1]));
  const double high = std::max(std::abs(error.interval[0]), std::abs(error.interval[1]));
  return fmt::format("the error of {} is {:.2f} mm {} than that of {} (95 %: {:.2f} to {:.2f})", other,
                     std::abs(error.difference), error.smaller() ? "smaller" : "larger", first, low, high);
}

std::string about_failures(const ComparisonRow& row) {
  const PairedFigure& failed = row.failed;
  const auto share = [](double fraction) { return fmt::format("{:.1f}", 100.0 * fraction); };
  const std::string both = share(failed.other) + " % against " + share(failed.first) + " %";
  if (!failed.larger() && !failed.smaller())
    return failed.other == 0.0 && failed.first == 0.0
               ? "none fails"
               : fmt::format("how often they fail is not told apart ({}; p {:.2f})", both,
                             failed.signed_rank_p);
  return fmt::format("it fails {}: {} (95 %: {:+.1f} to {:+.1f} points)",
                     failed.smaller() ? "less often" : "more often", both, 100.0 * failed.interval[0],
                     100.0 * failed.interval[1]);
}

/// What can be said, and no more than the intervals do.
std::string sentence(const ComparisonRow& row, const std::string& first, const std::string& other) {
  const std::string where = row.task + ", " + row.rig;
  if (row.error_mm.units < kLeastUnits)
    return fmt::format("{}: {} are too few to say anything of {} and {}.", where, scope(row), other, first);
  const bool apart =
      (row.error_mm.smaller() && row.failed.larger()) || (row.error_mm.larger() && row.failed.smaller());
  return fmt::format("{}: {}{}{} ({}).", where, about_errors(row, first, other), apart ? ", but " : "; ",
                     about_failures(row), scope(row));
}

bool starts_with(const std::string& text, const std::string& beginning) {
  return text.rfind(beginning, 0) == 0;
}

/// Keys that change the trials themselves, or how they are scored: not who drives, nor what is around it.
bool of_the_trials(const std::string& key) {
  if (key == "trials.count") return false;  // those of both are compared
  for (const char* group : {"rig.", "trials.", "score.", "reference.", "loop.", "safety.", "sensor."})
    if (starts_with(key, group)) return true;
  return key == "seed" || key == "rig_seed" || key == "sensor_seed";
}

std::vector<DifferentSetting> different_settings(const std::vector<ComparedRun>& runs) {
  std::vector<std::map<std::string, std::string>> values;
  std::set<std::string> keys;
  for (const ComparedRun& run : runs) {
    values.push_back(run.config.is_object() ? values_by_key(run.config)
                                            : std::map<std::string, std::string>());
    for (const auto& [key, value] : values.back()) keys.insert(key);
  }
  std::vector<DifferentSetting> found;
  for (const std::string& key : keys) {
    DifferentSetting setting{key, {}, of_the_trials(key)};
    for (const auto& run : values) {
      const auto value = run.find(key);
      setting.values.push_back(value == run.end() ? "" : value->second);
    }
    const auto& texts = setting.values;
    if (key != "threads" &&
        std::any_of(texts.begin(), texts.end(), [&](const auto& text) { return text != texts.front(); }))
      found.push_back(std::move(setting));
  }
  return found;
}

/// All rows of one run against the first.
std::vector<ComparisonRow> rows_of(const std::vector<ComparedRun>& runs, std::size_t index) {
  const ComparedRun& run = runs[index];
  const std::map<Key, const TrialRecord*> first = by_key(runs.front()), other = by_key(run);
  std::map<std::pair<std::string, std::string>, std::vector<Pair>> pairs;  // by task and kind of rig
  std::map<std::pair<std::string, std::string>, std::int64_t> found;       // in either
  for (const auto& [key, trial] : first) ++found[{std::get<0>(key), std::get<1>(key)}];
  for (const auto& [key, trial] : other) {
    const std::pair<std::string, std::string> group(std::get<0>(key), std::get<1>(key));
    ++found[group];
    const auto same = first.find(key);
    if (same == first.end() || !same_trial(*same->second, *trial)) continue;
    const bool shared = std::get<1>(key) == "unseen" && run.per_rig > 0;
    pairs[group].push_back({same->second, trial, shared ? trial->trial / run.per_rig : trial->trial});
  }
  if (pairs.empty())
    throw ConfigError(
        "compare: " + run.name + " shares no trial with " + runs.front().name +
        ": their tasks, starts or targets are others; drive both with the same --task, seed and "
        "number of trials");
  std::vector<ComparisonRow> rows;
  for (const char* task : kTasks)
    for (const char* rig : {"explored", "unseen", "real"}) {
      const auto group = pairs.find({task, rig});
      if (group == pairs.end()) continue;
      ComparisonRow row;
      row.task = task;
      row.rig = rig;
      row.other = static_cast<std::int64_t>(index);
      row.one_rig = row.rig != "unseen";
      row.rigs_are_units = !row.one_rig && run.per_rig > 0;
      row.left_out = found[group->first] - 2 * static_cast<std::int64_t>(group->second.size());
      row.error_mm = paired(group->second, error_mm);
      row.failed = paired(group->second, failed);
      row.stopped = paired(group->second, stopped);
      row.error_of_successes_mm = paired_if_any(group->second, error_of_success_mm);
      row.seconds_to_reach = paired_if_any(group->second, seconds);
      row.completion = paired_if_any(group->second, completion);
      for (const Pair& pair : group->second)
        row.errors_mm.push_back({*error_mm(*pair.first), *error_mm(*pair.other)});
      row.sentence = sentence(row, runs.front().name, run.name);
      rows.push_back(std::move(row));
    }
  return rows;
}

}  // namespace

Comparison compare_runs(const std::vector<ComparedRun>& runs) {
  if (runs.size() < 2) throw ConfigError("compare: name two runs at least");
  Comparison comparison;
  for (const ComparedRun& run : runs) {
    if (std::count(comparison.runs.begin(), comparison.runs.end(), run.name) > 0)
      throw ConfigError("compare: " + run.name + " is named twice");
    if (run.per_rig != runs.front().per_rig)
      throw ConfigError(
          fmt::format("compare: {} drove {} trials on each unseen rig and {} {}: their rigs are "
                      "not the same",
                      run.name, std::max<std::int64_t>(run.per_rig, 1), runs.front().name,
                      std::max<std::int64_t>(runs.front().per_rig, 1)));
    comparison.runs.push_back(run.name);
    comparison.controllers.push_back(run.controller);
  }
  for (std::size_t index = 1; index < runs.size(); ++index)
    for (ComparisonRow& row : rows_of(runs, index)) comparison.rows.push_back(std::move(row));
  comparison.settings = different_settings(runs);
  return comparison;
}

}  // namespace lodestone::runs
