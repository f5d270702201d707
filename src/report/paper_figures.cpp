#include "lodestone/report/paper_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>
#include <set>

#include "lodestone/common/statistics.h"

namespace lodestone::report {
namespace {

using common::Interval;
using common::mean;
using runs::CellRecord;
using runs::KeptCurve;
using runs::KeptTrials;
using Groups = std::vector<std::vector<double>>;

std::array<double, 2> ends(const Interval& interval) { return {interval.low, interval.high}; }

Interval interval_of(const Groups& groups) {
  return common::nested_bootstrap_interval(groups, mean, common::RandomStream(1, "bootstrap"));
}

std::vector<double> all_of(const Groups& groups) {
  std::vector<double> all;
  for (const auto& group : groups) all.insert(all.end(), group.begin(), group.end());
  return all;
}

void add_once(std::vector<std::string>& list, const std::string& text) {
  if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
}

runs::CellOrigin origin_of(const SeedRecords& seeds) {
  runs::CellOrigin origin;
  origin.n_seeds = static_cast<std::int64_t>(seeds.found.size());
  origin.n_seeds_planned = seeds.planned;
  for (const auto& [seed, record] : seeds.found)
    for (const std::string& commit : record->told("git_commit")) add_once(origin.commits, commit);
  return origin;
}

Groups values_of(const SeedRecords& seeds,
                 const std::function<std::vector<double>(const KeptTrials&)>& pick) {
  Groups groups;
  for (const auto& [seed, record] : seeds.found) groups.push_back(pick(*record->trials));
  return groups;
}

std::optional<double> mean_of(const SeedRecords& seeds, std::vector<double> KeptTrials::*figure) {
  const std::vector<double> all =
      all_of(values_of(seeds, [&](const KeptTrials& trials) { return trials.*figure; }));
  return all.empty() ? std::nullopt : std::optional(mean(all));
}

/// Differences of the errors on the same trials of the same seeds.
Groups differences(const SeedRecords& seeds, const SeedRecords& baseline) {
  Groups groups;
  for (const auto& [seed, record] : seeds.found)
    for (const auto& [other_seed, other] : baseline.found) {
      if (seed != other_seed || record->seed != other->seed) continue;
      const std::vector<double>&a = record->trials->error_mm, &b = other->trials->error_mm;
      groups.emplace_back();
      for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) groups.back().push_back(a[i] - b[i]);
    }
  return groups;
}

runs::PooledErrors errors_of(const SeedRecords& seeds, const SeedRecords* baseline) {
  runs::PooledErrors out;
  const Groups errors = values_of(seeds, [](const KeptTrials& trials) { return trials.error_mm; });
  const std::vector<double> all = all_of(errors);
  out.mean_error_mm = mean(all);
  out.std_error_mm = common::standard_deviation(all);
  out.median_error_mm = common::median(all);
  out.mean_interval_mm = ends(interval_of(errors));
  const Groups success = values_of(seeds, [](const KeptTrials& trials) {
    return std::vector<double>(trials.success.begin(), trials.success.end());
  });
  const std::vector<double> succeeded = all_of(success);
  out.success_rate = mean(succeeded);
  const Interval drawn = interval_of(success);
  const Interval wilson =
      common::wilson_interval(std::llround(out.success_rate * static_cast<double>(all.size())),
                              static_cast<std::int64_t>(all.size()));
  out.success_interval = {std::min(drawn.low, wilson.low), std::max(drawn.high, wilson.high)};
  out.target_deviation_mm = mean_of(seeds, &KeptTrials::target_deviation_mm);
  if (out.target_deviation_mm)
    out.target_deviation_std_mm = common::standard_deviation(
        all_of(values_of(seeds, [](const KeptTrials& trials) { return trials.target_deviation_mm; })));
  out.time_rms_error_mm = mean_of(seeds, &KeptTrials::time_rms_error_mm);
  out.completion = mean_of(seeds, &KeptTrials::completion);
  out.corners_reached = mean_of(seeds, &KeptTrials::corners_reached);
  out.frechet_mm = mean_of(seeds, &KeptTrials::frechet_mm);
  if (baseline != nullptr) {
    const Groups paired = differences(seeds, *baseline);
    if (!paired.empty()) {
      out.from_baseline_mm = mean(all_of(paired));
      out.from_baseline_interval_mm = ends(interval_of(paired));
    }
  }
  out.n_trials = static_cast<std::int64_t>(all.size());
  for (const auto& [seed, record] : seeds.found)
    out.n_stopped += std::count(record->trials->stopped.begin(), record->trials->stopped.end(), 1);
  out.origin = origin_of(seeds);
  return out;
}

/// When a return was within 5 % of its rise below its maximum, and whether it had stopped rising by then.
/// Evaluations are smoothed over five.
struct Convergence {
  bool converged = false;
  std::size_t reached = 0;  ///< entry of the curve
};

Convergence convergence_of(const std::vector<double>& returns) {
  constexpr std::size_t kSmoothed = 5;
  constexpr double kOfTheRise = 0.05;
  if (returns.size() < 2 * kSmoothed) return {};
  std::vector<double> smooth;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const std::size_t first = i < kSmoothed ? 0 : i - kSmoothed + 1;
    double sum = 0.0;
    for (std::size_t k = first; k <= i; ++k) sum += returns[k];
    smooth.push_back(sum / static_cast<double>(i - first + 1));
  }
  const auto last_fifth = smooth.begin() + static_cast<std::ptrdiff_t>(smooth.size() * 4 / 5);
  const double before = *std::max_element(smooth.begin(), last_fifth);
  const double most = std::max(before, *std::max_element(last_fifth, smooth.end()));
  const double rise = most - smooth.front();
  Convergence found;
  found.converged = rise > 0.0 && most - before <= kOfTheRise * rise;
  const auto reached = std::find_if(smooth.begin(), smooth.end(),
                                    [&](double value) { return value >= most - kOfTheRise * rise; });
  found.reached = static_cast<std::size_t>(reached - smooth.begin());
  return found;
}

double unsteadiness_of(const std::vector<double>& returns) {
  const auto last_fifth = returns.end() - static_cast<std::ptrdiff_t>((returns.size() + 4) / 5);
  return common::standard_deviation({last_fifth, returns.end()});
}

runs::PooledTraining training_of(const SeedRecords& seeds) {
  runs::PooledTraining out;
  std::vector<double> steps, wall, processor, returns, success, unsteadiness, wall_to, processor_to, steps_to;
  for (const auto& [seed, record] : seeds.found) {
    const KeptCurve& curve = *record->curve;
    steps.push_back(static_cast<double>(record->policy->env_steps));
    const bool timed = record->threads() == 1;
    if (timed) wall.push_back(record->policy->train_seconds);
    if (timed) processor.push_back(record->policy->processor_seconds.value_or(0.0));
    returns.push_back(curve.episode_return.back());
    success.push_back(record->policy->fresh_evaluation ? record->policy->fresh_evaluation->success_rate
                                                       : 0.0);
    unsteadiness.push_back(unsteadiness_of(curve.episode_return));
    const Convergence convergence = convergence_of(curve.episode_return);
    if (!convergence.converged) continue;
    ++out.n_converged;
    if (timed) wall_to.push_back(curve.seconds[convergence.reached]);
    if (timed) processor_to.push_back(curve.processor_seconds[convergence.reached]);
    steps_to.push_back(curve.env_steps[convergence.reached]);
  }
  out.env_steps = mean(steps);
  if (!wall.empty()) {
    out.train_seconds = mean(wall);
    out.processor_seconds = mean(processor);
  }
  out.final_return = mean(returns);
  out.success_rate = mean(success);
  out.unsteadiness = mean(unsteadiness);
  if (steps_to.size() == seeds.found.size()) {
    out.steps_to_maximum = mean(steps_to);
    if (!wall_to.empty()) {
      out.seconds_to_maximum = mean(wall_to);
      out.processor_seconds_to_maximum = mean(processor_to);
    }
  }
  out.origin = origin_of(seeds);
  return out;
}

std::vector<double> final_returns(const SeedRecords& seeds) {
  std::vector<double> returns;
  for (const auto& [seed, record] : seeds.found)
    if (record->curve && !record->curve->episode_return.empty())
      returns.push_back(record->curve->episode_return.back());
  return returns;
}

/// What 1 to 3 environments that replay change.
void compare_mixes(const std::vector<std::pair<std::string, SeedRecords>>& groups, runs::PaperResult& out) {
  const auto without = out.mixes.find("0");
  if (without == out.mixes.end()) return;
  const auto returns_of = [&](const std::string& prefix) {
    for (const auto& [name, seeds] : groups)
      if (name == prefix) return final_returns(seeds);
    return std::vector<double>();
  };
  const std::vector<double> none = returns_of("mix/0");
  for (const char* k : {"1", "2", "3"}) {
    const auto mix = out.mixes.find(k);
    if (mix == out.mixes.end()) continue;
    const std::vector<double> returns = returns_of(std::string("mix/") + k);
    runs::MixDifference& difference = out.mix_differences[k];
    difference.final_return = mean(returns) - mean(none);
    difference.final_return_interval =
        ends(common::difference_interval(returns, none, common::RandomStream(1, "bootstrap")));
    difference.unsteadiness = mix->second.unsteadiness;
    difference.unsteadiness_without = without->second.unsteadiness;
    difference.steps_to_maximum = mix->second.steps_to_maximum;
    difference.steps_to_maximum_without = without->second.steps_to_maximum;
    difference.n_seeds = static_cast<std::int64_t>(std::min(returns.size(), none.size()));
  }
}

runs::PooledDynamics dynamics_of(const SeedRecords& seeds) {
  runs::PooledDynamics out;
  std::vector<double> validation, test, position, heading;
  for (const auto& [seed, record] : seeds.found) {
    const runs::DynamicsEvaluation& evaluation = *record->dynamics;
    if (evaluation.training) validation.push_back(evaluation.training->validation_loss);
    if (evaluation.normalised_l2) test.push_back(*evaluation.normalised_l2);
    position.push_back(evaluation.one_step.position_rms_mm);
    if (evaluation.one_step.heading_rms_deg) heading.push_back(*evaluation.one_step.heading_rms_deg);
  }
  out.validation_loss = mean(validation);
  out.test_loss = mean(test);
  out.position_rms_mm = mean(position);
  if (!heading.empty()) out.heading_rms_deg = mean(heading);
  out.origin = origin_of(seeds);
  return out;
}

std::vector<std::string> parts_of(const std::string& id) {
  std::vector<std::string> parts(1);
  for (const char c : id) {
    if (c == '/')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

/// Names of folders have no spaces.
std::string shown(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

void note_origins(const runs::KeptPlan& kept, runs::PaperResult& out) {
  out.n_cells = static_cast<std::int64_t>(kept.records.size());
  out.n_cells_planned = static_cast<std::int64_t>(kept.plan.cells.size());
  std::set<std::string> dates;
  for (const runs::Cell& cell : kept.plan.cells) {
    const auto found = kept.records.find(cell.id);
    if (found == kept.records.end()) continue;
    const CellRecord& record = found->second;
    for (const std::string& commit : record.told("git_commit")) add_once(out.commits, commit);
    const auto processors = record.machine.is_object() ? record.machine.value("processors", 0) : 0;
    for (const std::string& processor : record.told("processor"))
      add_once(out.machines, processor + ", " + std::to_string(processors) + " processors");
    for (const std::string& time_utc : record.told("time_utc")) dates.insert(time_utc.substr(0, 10));
    out.cell_hours += record.seconds / 3600.0;
  }
  out.dates.assign(dates.begin(), dates.end());
}

}  // namespace

std::vector<std::pair<std::string, SeedRecords>> by_prefix(const runs::KeptPlan& kept) {
  std::vector<std::pair<std::string, SeedRecords>> groups;
  std::map<std::string, std::size_t> place;
  for (const runs::Cell& cell : kept.plan.cells) {
    const std::size_t slash = cell.id.rfind('/');
    const std::int64_t seed = slash == std::string::npos ? 0 : std::atoll(cell.id.c_str() + slash + 1);
    const std::string prefix = seed > 0 ? cell.id.substr(0, slash) : cell.id;
    const auto [found, fresh] = place.emplace(prefix, groups.size());
    if (fresh) groups.emplace_back(prefix, SeedRecords{});
    SeedRecords& group = groups[found->second].second;
    ++group.planned;
    const auto record = kept.records.find(cell.id);
    if (record != kept.records.end()) group.found.emplace_back(seed, &record->second);
  }
  return groups;
}

runs::PaperResult paper_figures(const runs::KeptPlan& kept) {
  runs::PaperResult out;
  out.scale = kept.plan.name;
  note_origins(kept, out);
  const auto groups = by_prefix(kept);
  std::map<std::string, const SeedRecords*> baseline;  // by task
  for (const auto& [prefix, seeds] : groups)
    if (prefix.rfind("transfer/baseline/bare/", 0) == 0) baseline[parts_of(prefix).back()] = &seeds;
  for (const auto& [prefix, seeds] : groups) {
    if (seeds.found.empty()) continue;
    const std::vector<std::string> parts = parts_of(prefix);
    const CellRecord& first = *seeds.found.front().second;
    const std::string& kind = parts.front();
    if (first.trials) {
      const std::string& task = parts.back();
      if (kind == "transfer") {
        const bool itself = parts[1] == "baseline" && parts[2] == "bare";
        out.transfer[parts[1]][parts[2]][task] = errors_of(seeds, itself ? nullptr : baseline[task]);
      } else {
        (kind == "open" ? out.open_choices : out.ablations)[shown(parts[1])][task] =
            errors_of(seeds, nullptr);
      }
    } else if (first.policy && first.curve && !first.curve->episode_return.empty()) {
      const runs::PooledTraining training = training_of(seeds);
      if (kind == "policy") out.training[parts[1]][parts[2]] = training;
      if (kind == "mix") out.mixes[parts[1]] = training;
      if (kind == "open")
        out.open_trainings[shown(parts[1]) + (parts[2] == "mix" ? ", " + parts[3] + " of 3" : "")] = training;
    } else if (first.dynamics && kind != "ablation") {
      out.dynamics[kind == "open" ? shown(parts[1]) : parts[1]] = dynamics_of(seeds);
    }
  }
  compare_mixes(groups, out);
  return out;
}

}  // namespace lodestone::report
