#include "lodestone/report/paper_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <optional>
#include <set>

#include "lodestone/common/statistics.h"
#include "lodestone/common/student_interval.h"
#include "lodestone/runs/run_folder.h"
#include "mean_bootstrap.h"
#include "paper_page.h"

namespace lodestone::report {
namespace {

using common::Interval;
using common::mean;
using runs::CellRecord;
using runs::KeptCurve;
using runs::KeptTrials;
using Groups = std::vector<std::vector<double>>;

std::array<double, 2> ends(const Interval& interval) { return {interval.low, interval.high}; }

/// Of what seeds have, one value of each.
std::optional<std::array<double, 2>> over_seeds(const std::vector<double>& values) {
  const auto interval = common::student_interval(values);
  return interval ? std::optional(ends(*interval)) : std::nullopt;
}

std::array<double, 2> range_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return {*low, *high};
}

Interval interval_of(const Groups& groups) {
  thread_local MeanBootstrap bootstrap("bootstrap");
  return bootstrap.interval(groups);
}

std::vector<double> all_of(const Groups& groups) {
  std::vector<double> all;
  for (const auto& group : groups) all.insert(all.end(), group.begin(), group.end());
  return all;
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

runs::CellOrigin origin_of(const SeedRecords& seeds) {
  runs::CellOrigin origin;
  origin.n_seeds = static_cast<std::int64_t>(seeds.found.size());
  origin.n_seeds_planned = seeds.planned;
  for (const auto& [seed, record] : seeds.found) {
    add_new(origin.commits, record->manifest_texts("git_commit"));
    add_new(origin.processors, record->manifest_texts("processor"));
  }
  return origin;
}

using Pick = std::function<std::vector<double>(const KeptTrials&)>;

std::vector<double> errors_mm(const KeptTrials& trials) { return trials.error_mm; }
std::vector<double> deviations_mm(const KeptTrials& trials) { return trials.target_deviation_mm; }
std::vector<double> successes(const KeptTrials& trials) {
  return {trials.success.begin(), trials.success.end()};
}

Groups values_of(const SeedRecords& seeds, const Pick& pick) {
  Groups groups;
  for (const auto& [seed, record] : seeds.found) groups.push_back(pick(*record->trials));
  return groups;
}

using Ends = std::optional<std::array<double, 2>>;

/// Means of what only paths have, and their intervals; absent where trials have none.
void pool(const SeedRecords& seeds, std::vector<double> KeptTrials::*figure, std::optional<double>& out,
          Ends& interval) {
  const Groups groups = values_of(seeds, [&](const KeptTrials& trials) { return trials.*figure; });
  const std::vector<double> all = all_of(groups);
  if (all.empty()) return;
  out = mean(all);
  interval = ends(interval_of(groups));
}

/// Differences of a figure on the same trials of the same seeds.
Groups differences(const SeedRecords& seeds, const SeedRecords& reference, const Pick& pick) {
  Groups groups;
  for (const auto& [seed, record] : seeds.found)
    for (const auto& [other_seed, other] : reference.found) {
      if (seed != other_seed || record->seed != other->seed) continue;
      const std::vector<double> a = pick(*record->trials), b = pick(*other->trials);
      groups.emplace_back();
      for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) groups.back().push_back(a[i] - b[i]);
    }
  return groups;
}

runs::PooledErrors errors_of(const SeedRecords& seeds, const SeedRecords* reference) {
  runs::PooledErrors out;
  const Groups errors = values_of(seeds, errors_mm);
  const std::vector<double> all = all_of(errors);
  out.mean_error_mm = mean(all);
  out.std_error_mm = common::standard_deviation(all);
  out.median_error_mm = common::median(all);
  out.mean_interval_mm = ends(interval_of(errors));
  const Groups success = values_of(seeds, successes);
  const std::vector<double> succeeded = all_of(success);
  out.success_rate = mean(succeeded);
  const Interval drawn = interval_of(success);
  const Interval wilson =
      common::wilson_interval(std::llround(out.success_rate * static_cast<double>(all.size())),
                              static_cast<std::int64_t>(all.size()));
  out.success_interval = {std::min(drawn.low, wilson.low), std::max(drawn.high, wilson.high)};
  pool(seeds, &KeptTrials::target_deviation_mm, out.target_deviation_mm, out.target_deviation_interval_mm);
  if (out.target_deviation_mm)
    out.target_deviation_std_mm = common::standard_deviation(all_of(values_of(seeds, deviations_mm)));
  pool(seeds, &KeptTrials::time_rms_error_mm, out.time_rms_error_mm, out.time_rms_interval_mm);
  pool(seeds, &KeptTrials::completion, out.completion, out.completion_interval);
  pool(seeds, &KeptTrials::corners_reached, out.corners_reached, out.corners_interval);
  if (reference != nullptr) {
    const Groups paired = differences(seeds, *reference, errors_mm);
    const std::vector<double> shared = all_of(paired);
    if (!shared.empty()) {
      out.from_reference_mm = mean(shared);
      out.from_reference_interval_mm = ends(interval_of(paired));
      out.n_shared_trials = static_cast<std::int64_t>(shared.size());
    }
    const Groups deviations = differences(seeds, *reference, deviations_mm);
    const std::vector<double> deviated = all_of(deviations);
    if (!deviated.empty()) {
      out.target_deviation_from_reference_mm = mean(deviated);
      out.target_deviation_from_reference_interval_mm = ends(interval_of(deviations));
    }
  }
  out.n_trials = static_cast<std::int64_t>(all.size());
  for (const auto& [seed, record] : seeds.found)
    out.n_stopped += std::count(record->trials->stopped.begin(), record->trials->stopped.end(), 1);
  out.origin = origin_of(seeds);
  return out;
}

/// Absent where they share no trial.
std::optional<runs::PairedErrors> paired_errors(const SeedRecords& seeds, const SeedRecords& others) {
  const auto pooled = [&](const Pick& pick) -> std::optional<runs::PooledMean> {
    const Groups groups = differences(seeds, others, pick);
    const std::vector<double> all = all_of(groups);
    if (all.empty()) return std::nullopt;
    return runs::PooledMean{mean(all), ends(interval_of(groups))};
  };
  const auto error_mm = pooled(errors_mm), success_rate = pooled(successes);
  if (!error_mm || !success_rate) return std::nullopt;
  runs::PairedErrors out{*error_mm, *success_rate, pooled(deviations_mm)};
  for (const auto& group : differences(seeds, others, errors_mm)) {
    out.n_trials += static_cast<std::int64_t>(group.size());
    ++out.n_seeds;
  }
  return out;
}

/// Whether a return had stopped rising, when it came within 5 % of its rise of its maximum, and whether it
/// ended lower than that again. The maximum, and the end, are means of five evaluations; it comes there with
/// the first evaluation from which on five have such a mean, and which is there itself.
struct Convergence {
  bool converged = false, fallen = false;
  std::size_t reached = 0;  ///< entry of the curve
};

Convergence convergence_of(const std::vector<double>& returns) {
  constexpr std::size_t kSmoothed = 5;
  constexpr double kOfTheRise = 0.05;
  if (returns.size() < 2 * kSmoothed) return {};
  std::vector<double> smooth;  // of five that follow one another, by the first of them
  for (std::size_t i = 0; i + kSmoothed <= returns.size(); ++i) {
    const auto first = returns.begin() + static_cast<std::ptrdiff_t>(i);
    smooth.push_back(mean({first, first + kSmoothed}));
  }
  const std::size_t last_fifth = returns.size() * 4 / 5 - (kSmoothed - 1);
  const auto late = smooth.begin() + static_cast<std::ptrdiff_t>(last_fifth);
  const double before = *std::max_element(smooth.begin(), late);
  const double most = std::max(before, *std::max_element(late, smooth.end()));
  const double rise = most - std::min(returns.front(), smooth.front());
  const double there = most - kOfTheRise * rise;
  Convergence found;
  found.converged = rise > 0.0 && most - before <= kOfTheRise * rise;
  found.fallen = smooth.back() < there;
  const auto is_there = [&](double value) { return value >= there; };
  const auto from = std::find_if(smooth.begin(), smooth.end(), is_there) - smooth.begin();
  found.reached = static_cast<std::size_t>(std::find_if(returns.begin() + from, returns.end(), is_there) -
                                           returns.begin());
  return found;
}

double unsteadiness_of(const std::vector<double>& returns) {
  const auto last_fifth = returns.end() - static_cast<std::ptrdiff_t>((returns.size() + 4) / 5);
  return common::standard_deviation({last_fifth, returns.end()});
}

/// Of a task's preset, where that says so.
std::optional<double> success_radius_mm(const CellRecord& record) {
  const common::Json* key = &record.preset;
  for (const char* part : {"task", "success_radius_m"}) {
    if (!key->is_object() || !key->contains(part)) return std::nullopt;
    key = &(*key)[part];
  }
  return key->is_number() ? std::optional(1e3 * key->get<double>()) : std::nullopt;
}

}  // namespace

runs::PooledTraining pooled_training(const SeedRecords& seeds) {
  runs::PooledTraining out;
  std::vector<double> steps, wall, returns, lowest, highest, success, unsteadiness;
  std::vector<double> wall_to, steps_to;
  for (const auto& [seed, record] : seeds.found) {
    const KeptCurve& curve = *record->curve;
    steps.push_back(static_cast<double>(record->policy->env_steps));
    const bool timed = record->threads() == 1;
    if (timed) wall.push_back(record->policy->train_seconds);
    returns.push_back(curve.episode_return.back());
    lowest.push_back(*std::min_element(curve.episode_return.begin(), curve.episode_return.end()));
    highest.push_back(*std::max_element(curve.episode_return.begin(), curve.episode_return.end()));
    if (record->policy->products) add_new(out.products, {*record->policy->products});
    if (!out.success_radius_mm) out.success_radius_mm = success_radius_mm(*record);
    success.push_back(record->policy->fresh_evaluation ? record->policy->fresh_evaluation->success_rate
                                                       : 0.0);
    unsteadiness.push_back(unsteadiness_of(curve.episode_return));
    const Convergence convergence = convergence_of(curve.episode_return);
    if (convergence.fallen) ++out.n_fallen;
    if (!convergence.converged) continue;
    ++out.n_converged;
    if (timed) wall_to.push_back(curve.seconds[convergence.reached]);
    steps_to.push_back(curve.env_steps[convergence.reached]);
  }
  out.env_steps = mean(steps);
  out.n_timed = static_cast<std::int64_t>(wall.size());
  if (!wall.empty()) out.train_seconds = mean(wall);
  out.final_return = mean(returns);
  out.final_return_interval = over_seeds(returns);
  out.lowest_return = mean(lowest);
  out.highest_return = mean(highest);
  out.success_rate = mean(success);
  out.success_range = range_of(success);
  out.unsteadiness = mean(unsteadiness);
  out.unsteadiness_range = range_of(unsteadiness);
  if (steps_to.size() == seeds.found.size()) {
    out.steps_to_maximum = mean(steps_to);
    out.steps_to_maximum_range = range_of(steps_to);
    if (!wall_to.empty()) out.seconds_to_maximum = mean(wall_to);
  }
  out.origin = origin_of(seeds);
  return out;
}

SeedRecords with_seeds_of(const SeedRecords& seeds, const SeedRecords& others) {
  SeedRecords shared;
  shared.planned = seeds.planned;
  for (const auto& own : seeds.found)
    for (const auto& [seed, record] : others.found)
      if (own.first == seed) shared.found.push_back(own);
  return shared;
}

namespace {

bool are_trainings(const SeedRecords& seeds) {
  return std::all_of(seeds.found.begin(), seeds.found.end(), [](const auto& found) {
    const CellRecord& record = *found.second;
    return record.policy && record.curve && !record.curve->episode_return.empty();
  });
}

/// Absent where they share no seed.
std::optional<runs::TrainingDifference> training_difference(const SeedRecords& seeds,
                                                            const SeedRecords& others) {
  const SeedRecords own = with_seeds_of(seeds, others), other = with_seeds_of(others, seeds);
  if (own.found.empty()) return std::nullopt;
  std::vector<double> returns;
  for (std::size_t i = 0; i < own.found.size(); ++i)
    returns.push_back(own.found[i].second->curve->episode_return.back() -
                      other.found[i].second->curve->episode_return.back());
  const runs::PooledTraining a = pooled_training(own), b = pooled_training(other);
  runs::TrainingDifference out;
  out.final_return = mean(returns);
  out.final_return_interval = over_seeds(returns);
  out.unsteadiness = a.unsteadiness;
  out.unsteadiness_of_other = b.unsteadiness;
  out.steps_to_maximum = a.steps_to_maximum;
  out.steps_to_maximum_of_other = b.steps_to_maximum;
  out.n_seeds = static_cast<std::int64_t>(returns.size());
  return out;
}

/// Mixes against none, and what the paper leaves open against what was chosen of it.
void compare_trainings(const std::map<std::string, const SeedRecords*>& groups, runs::PaperResult& out) {
  const auto compare = [&](const std::string& prefix, const std::string& other, auto& differences,
                           const std::string& key) {
    const auto own = groups.find(prefix), with = groups.find(other);
    if (own == groups.end() || with == groups.end()) return;
    if (!are_trainings(*own->second) || !are_trainings(*with->second)) return;
    if (const auto difference = training_difference(*own->second, *with->second))
      differences[key] = *difference;
  };
  for (const std::string k : {"1", "2", "3"}) compare("mix/" + k, "mix/0", out.mix_differences, k);
  for (const auto& [prefix, seeds] : groups) {
    const std::vector<std::string> parts = parts_of(prefix);
    if (parts.front() != "open" || parts.size() < 3) continue;
    if (parts[2] == "policy") compare(prefix, "policy/paper/centre", out.open_differences, shown(parts[1]));
    if (parts[2] == "mix" && parts.size() > 3)
      compare(prefix, "mix/" + parts[3], out.open_differences, shown(parts[1]) + ", " + parts[3] + " of 3");
  }
}

/// Where the same controller learned: in a simulator that was learned, and in the plain one.
void compare_simulators(const std::map<std::string, const SeedRecords*>& groups, runs::PaperResult& out) {
  for (const auto& [learned, plain] :
       {std::pair<std::string, std::string>{"paper", "paper_simulator"}, {"best", "simulator"}})
    for (const std::string variant : {"bare", "decorated", "whole_dish"})
      for (const std::string task : {"centre", "point", "square"}) {
        const std::string end = "/" + variant + "/" + task;
        const auto own = groups.find("transfer/" + learned + end),
                   other = groups.find("transfer/" + plain + end);
        if (own == groups.end() || other == groups.end()) continue;
        if (const auto paired = paired_errors(*own->second, *other->second))
          out.learned_minus_plain[learned][variant][task] = *paired;
      }
}

/// What meets the same trials as a variant of Table II.
std::string bare_pull(const std::string& variant, const std::string& task) {
  return "transfer/baseline/" + (variant == "whole_dish" ? variant : "bare") + "/" + task;
}

/// Whether likelihood was learned, of which the loss is no distance.
bool learned_likelihood(const CellRecord& record) {
  const common::Json model =
      record.preset.is_object() ? record.preset.value("model", common::Json()) : common::Json();
  return model.is_object() && model.value("components", 0) > 0;
}

runs::PooledDynamics dynamics_of(const SeedRecords& seeds) {
  runs::PooledDynamics out;
  std::vector<double> validation, test, position, heading, no_motion, neighbours;
  for (const auto& [seed, record] : seeds.found) {
    const runs::DynamicsEvaluation& evaluation = *record->dynamics;
    if (evaluation.training && !learned_likelihood(*record))
      validation.push_back(evaluation.training->validation_loss);
    if (evaluation.baselines) {
      no_motion.push_back(evaluation.baselines->no_motion.position_rms_mm);
      neighbours.push_back(evaluation.baselines->nearest_neighbours.position_rms_mm);
    }
    if (evaluation.normalised_l2) test.push_back(*evaluation.normalised_l2);
    position.push_back(evaluation.one_step.position_rms_mm);
    if (evaluation.one_step.heading_rms_deg) heading.push_back(*evaluation.one_step.heading_rms_deg);
  }
  if (!validation.empty()) out.validation_loss = mean(validation);
  out.validation_loss_interval = over_seeds(validation);
  out.test_loss = mean(test);
  out.test_loss_interval = over_seeds(test);
  out.position_rms_mm = mean(position);
  out.position_rms_interval_mm = over_seeds(position);
  if (!heading.empty()) out.heading_rms_deg = mean(heading);
  out.heading_rms_interval_deg = over_seeds(heading);
  if (!no_motion.empty()) out.no_motion_mm = mean(no_motion);
  if (!neighbours.empty()) out.neighbours_mm = mean(neighbours);
  out.origin = origin_of(seeds);
  return out;
}

/// Between the evaluations of the second half; absent where there is none of one.
std::optional<runs::TrainingPace> pace_of(const SeedRecords& seeds) {
  const CellRecord& record = *seeds.found.front().second;
  const KeptCurve& curve = *record.curve;
  const std::size_t from = curve.env_steps.size() / 2;
  if (curve.env_steps.size() < 2 || curve.seconds.back() <= curve.seconds[from]) return std::nullopt;
  const double seconds = curve.seconds.back() - curve.seconds[from];
  runs::TrainingPace pace;
  pace.warm_up_steps = curve.env_steps[from];
  pace.warm_up_s = curve.seconds[from];
  pace.steps_per_s = (curve.env_steps.back() - curve.env_steps[from]) / seconds;
  pace.processor_share = (curve.processor_seconds.back() - curve.processor_seconds[from]) / seconds;
  if (record.policy->other_processor_seconds)
    pace.others = *record.policy->other_processor_seconds / record.policy->train_seconds;
  if (record.policy->products) pace.products.push_back(*record.policy->products);
  pace.origin = origin_of(seeds);
  return pace;
}

void note_origins(const runs::KeptPlan& kept, runs::PaperResult& out) {
  out.n_cells = static_cast<std::int64_t>(kept.records.size());
  out.n_cells_planned = static_cast<std::int64_t>(kept.plan.cells.size());
  std::set<std::string> dates;
  for (const runs::Cell& cell : kept.plan.cells) {
    const auto found = kept.records.find(cell.id);
    if (found == kept.records.end()) continue;
    const CellRecord& record = found->second;
    add_new(out.commits, record.manifest_texts("git_commit"));
    for (const common::Json& part : runs::manifests_of(record.machine)) {
      const common::Json name = part.value("processor", common::Json());
      const common::Json processors = part.value("processors", common::Json());
      if (name.is_string() && processors.is_number_integer())
        add_new(out.machines, {name.get<std::string>() + ", " + processors.dump() + " processors"});
    }
    for (const std::string& time_utc : record.manifest_texts("time_utc"))
      dates.insert(time_utc.substr(0, 10));
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

runs::PaperResult paper_figures(const runs::KeptPlan& kept, const runs::KeptPlan& paces) {
  runs::PaperResult out;
  out.scale = kept.plan.name;
  note_origins(kept, out);
  const auto groups = by_prefix(kept);
  std::map<std::string, const SeedRecords*> by_id;
  for (const auto& [prefix, seeds] : groups) by_id[prefix] = &seeds;
  const auto reference = [&by_id](const std::string& own, const std::string& prefix) {
    const auto found = by_id.find(prefix);
    return found == by_id.end() || own == prefix ? nullptr : found->second;
  };
  for (const auto& [prefix, seeds] : groups) {
    if (seeds.found.empty()) continue;
    const std::vector<std::string> parts = parts_of(prefix);
    const CellRecord& first = *seeds.found.front().second;
    const std::string& kind = parts.front();
    if (first.trials) {
      const std::string& task = parts.back();
      if (kind == "transfer")
        out.transfer[parts[1]][parts[2]][task] =
            errors_of(seeds, reference(prefix, bare_pull(parts[2], task)));
      if (kind == "open")
        out.open_choices[shown(parts[1])][task] =
            errors_of(seeds, reference(prefix, "transfer/paper/bare/" + task));
      if (kind == "ablation")
        out.ablations[shown(parts[1])][task] =
            errors_of(seeds, reference(prefix, "ablation/best_preset/" + task));
    } else if (are_trainings(seeds)) {
      const runs::PooledTraining training = pooled_training(seeds);
      if (kind == "policy") out.training[parts[1]][parts[2]] = training;
      if (kind == "mix") out.mixes[parts[1]] = training;
      if (kind == "ablation") out.ablation_trainings[shown(parts[1])] = training;
      if (kind == "open")
        out.open_trainings[shown(parts[1]) + (parts[2] == "mix" ? ", " + parts[3] + " of 3" : "")] = training;
    } else if (first.dynamics && kind != "ablation") {
      out.dynamics[kind == "open" ? shown(parts[1]) : parts[1]] = dynamics_of(seeds);
    }
  }
  compare_trainings(by_id, out);
  compare_simulators(by_id, out);
  for (const auto& [id, cell] : by_prefix(paces)) {
    const std::vector<std::string> parts = parts_of(id);
    if (parts.front() != "pace" || cell.found.empty() || !are_trainings(cell)) continue;
    if (const auto pace = pace_of(cell)) out.paces[parts[1]][parts[2]] = *pace;
  }
  return out;
}

}  // namespace lodestone::report
