#include <algorithm>
#include <cmath>
#include <utility>

#include "lodestone/report/html.h"
#include "paper_page.h"

namespace lodestone::report {
namespace {

constexpr std::int64_t kEnoughTrials = 200;  ///< for a sentence about an ablation

std::string from_ours(const runs::TrainingDifference* d) {
  if (d == nullptr) return "–";
  std::string text = formatted("%+.2f", d->final_return);
  if (d->final_return_interval)
    text += formatted(" (%+.2f to %+.2f)", (*d->final_return_interval)[0], (*d->final_return_interval)[1]);
  return text + " (" + std::to_string(d->n_seeds) + (d->n_seeds == 1 ? " seed)" : " seeds)");
}

/// Which unit's returns are most like those that the paper tells.
std::string nearest_unit(const PaperPage& page) {
  constexpr double kLowest = -5.0, kHighest = 10.0;
  const auto* paper = find(page.result.training, "paper");
  const std::pair<const char*, const runs::PooledTraining*> units[] = {
      {"dish radii (ours)", paper != nullptr ? find(*paper, "centre") : nullptr},
      {"mm", find(page.result.open_trainings, "reward in mm")},
      {"m", find(page.result.open_trainings, "reward in m")}};
  const char* nearest = nullptr;
  double least = 0.0;
  for (const auto& [unit, training] : units) {
    if (training == nullptr) return "";
    const double off =
        std::abs(training->lowest_return - kLowest) + std::abs(training->highest_return - kHighest);
    if (nearest != nullptr && off >= least) continue;
    nearest = unit;
    least = off;
  }
  return std::string("Nearest to that come distances in ") + nearest + ". ";
}

}  // namespace

void add_open_choices(PaperPage& page) {
  PaperTable table{{"what the paper leaves open", "choice", "final return", "lowest to highest",
                    "final return from ours, same seeds", "success in the MBS",
                    "centre on unseen rigs, mean (95 % interval) (mm)", "from ours on the same trials (mm)",
                    "success there", "seeds", "precision"}};
  const runs::PooledErrors* ours_driven = page.errors("paper", "bare", "centre");
  const auto add = [&](const char* what, const std::string& choice, const runs::PooledTraining* training,
                       const std::string& from, const runs::PooledErrors* trials) {
    if (training == nullptr) return table.add_missing({what, choice});
    table.cells.push_back(
        {what, choice, with_interval("%.2f", training->final_return, training->final_return_interval),
         formatted("%.1f to %.1f", training->lowest_return, training->highest_return), from,
         success_text(*training), trials ? error_text(*trials) : "–",
         trials != nullptr && trials != ours_driven ? from_reference_text(*trials) : "–",
         trials ? success_text(*trials) : "–", seeds_text(training->origin), joined(training->products)});
    table.add_commits(training->origin);
  };
  const auto* paper = find(page.result.training, "paper");
  const runs::PooledTraining* ours = paper != nullptr ? find(*paper, "centre") : nullptr;
  const auto other = [&](const std::string& choice, const std::string& key, bool same_scale) {
    const auto* trials = find(page.result.open_choices, key);
    add("", choice, find(page.result.open_trainings, key),
        same_scale ? from_ours(find(page.result.open_differences, key)) : "–",
        trials != nullptr ? find(*trials, "centre") : nullptr);
  };
  add("unit of the distance in the reward", "dish radii (ours)", ours, "–", ours_driven);
  other("mm", "reward in mm", false);
  other("m", "reward in m", false);
  add("activation of the first layer", "none on the input itself (ours)", ours, "–", ours_driven);
  other("ReLU on the normalised input, too", "ReLU on the input", true);
  for (const char* k : {"1", "3"}) {
    add("recorded episodes of under 10 steps", std::string("left out (ours), ") + k + " of 3 replay",
        find(page.result.mixes, k), "–", nullptr);
    other(std::string("played as a whole, ") + k + " of 3 replay",
          std::string("short episodes kept, ") + k + " of 3", true);
  }
  page.add_part(
      "open", "What the paper leaves open",
      "Three of the choices that it leaves, as we took them and otherwise, as the paper's TD3 learns (not "
      "tried otherwise: how fast the square is fed, and step, momentum and epochs of the dynamics network). "
      "It says that the rewards of an episode lie between -5 and 10: compare the lowest and "
      "the highest evaluation. " +
          nearest_unit(page) +
          "Returns with distances in other units are on other scales; what such a policy does on unseen "
          "rigs, bare, is not. Intervals: of returns by Student's t over seeds, of trials as "
          "in Table II. Precision, of matrix products: the seeds of a row may differ in it, from those of "
          "the row they are compared with, too.",
      {{"", table}});
}

void add_ablations(PaperPage& page) {
  const auto is_row = [](const std::string& prefix) {
    return prefix.rfind("ablation/", 0) == 0 && prefix.size() > 6 &&
           prefix.compare(prefix.size() - 6, 6, "/point") == 0;
  };
  std::vector<std::string> names;
  for (const auto& [prefix, seeds] : page.groups)
    if (is_row(prefix)) names.push_back(prefix.substr(9, prefix.size() - 15));
  std::sort(names.begin(), names.end());
  std::stable_partition(names.begin(), names.end(), [](const auto& name) { return name == "best_preset"; });
  PaperTable table{{"our TD3 for points with one change", "point, mean (95 % interval) (mm)",
                    "from best preset, same trials (mm)", "point, success",
                    "square, mean (95 % interval) (mm)", "square, success", "trials of each", "seeds",
                    "steps", "precision"}};
  table.text_columns = 1;
  std::size_t few = 0;
  for (const std::string& folder : names) {
    std::string name = folder;
    std::replace(name.begin(), name.end(), '_', ' ');
    const auto* tasks = find(page.result.ablations, name);
    const runs::PooledErrors* point = tasks != nullptr ? find(*tasks, "point") : nullptr;
    const runs::PooledErrors* square = tasks != nullptr ? find(*tasks, "square") : nullptr;
    if (point == nullptr || square == nullptr) {
      table.add_missing({name});
      continue;
    }
    const std::int64_t trials = std::min(point->n_trials, square->n_trials);
    const runs::CellOrigin& fewest =
        point->origin.n_seeds < square->origin.n_seeds ? point->origin : square->origin;
    if (trials < kEnoughTrials || fewest.n_seeds < kEnoughSeeds) ++few;
    const runs::PooledTraining* training = find(page.result.ablation_trainings, name);
    table.cells.push_back({name, error_text(*point), from_reference_text(*point), success_text(*point),
                           error_text(*square), success_text(*square), std::to_string(trials),
                           seeds_text(fewest), training != nullptr ? grouped(training->env_steps) : "–",
                           training != nullptr ? joined(training->products) : "–"});
    table.add_commits(point->origin);
    if (training != nullptr) table.add_commits(training->origin);
  }
  if (table.cells.empty()) return;
  std::string note =
      "Each row changes one thing, and is trained for as many steps as the row named best preset: see the "
      "column, where that is fewer than in Table II. Unseen rigs, by camera, bare. Products of matrices are "
      "in bfloat16 where a processor is faster so: where a row's differ from best preset's, so does that. ";
  if (few > 0)
    note += std::to_string(few) + " of these rows have fewer than " + std::to_string(kEnoughTrials) +
            " trials or " + std::to_string(kEnoughSeeds) + " seeds: no sentence can be built on them.";
  page.add_part("ablations", "Ablations of our TD3, random target", note, {{"", table}});
}

}  // namespace lodestone::report
