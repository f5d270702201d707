#include "lodestone/report/html.h"
#include "paper_page.h"

namespace lodestone::report {
namespace {

constexpr std::int64_t kEnoughTrials = 200;  ///< for a sentence about an ablation

}  // namespace

void add_open_choices(PaperPage& page) {
  PaperTable table{{"what the paper leaves open", "choice", "final return", "success in the MBS",
                    "centre on unseen rigs, mean (95 % interval) (mm)", "success there", "seeds"}};
  const auto add = [&](const char* what, const std::string& choice, const runs::PooledTraining* training,
                       const runs::PooledErrors* trials) {
    if (training == nullptr) return table.add_missing({what, choice});
    table.cells.push_back({what, choice, text_of("%.2f", training->final_return),
                           text_of("%.0f %%", 100.0 * training->success_rate),
                           trials ? error_text(*trials) : "–", trials ? success_text(*trials) : "–",
                           seeds_text(training->origin)});
  };
  const auto* paper = find(page.result.training, "paper");
  const runs::PooledTraining* ours = paper != nullptr ? find(*paper, "centre") : nullptr;
  const runs::PooledErrors* ours_driven = page.errors("paper", "bare", "centre");
  const auto other = [&](const char* what, const std::string& choice, const std::string& key) {
    const auto* trials = find(page.result.open_choices, key);
    add(what, choice, find(page.result.open_trainings, key),
        trials != nullptr ? find(*trials, "centre") : nullptr);
  };
  add("unit of the distance in the reward",
      "dish radii (ours: rewards then stay within -5 to 10, as the paper says)", ours, ours_driven);
  other("", "mm", "reward in mm");
  other("", "m", "reward in m");
  add("activation of the first layer", "none on the input itself (ours)", ours, ours_driven);
  other("", "ReLU on the normalised input, too", "ReLU on the input");
  for (const char* k : {"1", "3"}) {
    add("recorded episodes of under 10 steps", std::string("left out (ours), ") + k + " of 3 replay",
        find(page.result.mixes, k), nullptr);
    other("", std::string("played as a whole, ") + k + " of 3 replay",
          std::string("short episodes kept, ") + k + " of 3");
  }
  page.markdown += "What the paper leaves open\n\n" + table.markdown() + "\n";
  page.html.add_section("open", "What the paper leaves open",
                        "<p>Returns with distances in other units are on other scales: compare success and "
                        "what the policy does on unseen "
                        "rigs, bare.</p>" +
                            table.html());
}

void add_ablations(PaperPage& page) {
  PaperTable table{{"our TD3 for points with one change", "point, mean (95 % interval) (mm)",
                    "point, success", "square, mean (95 % interval) (mm)", "square, success",
                    "trials of each", "seeds"}};
  table.text_columns = 1;
  std::size_t few = 0;
  std::vector<std::string> names;
  for (const auto& [name, tasks] : page.result.ablations)
    if (name != "best preset") names.push_back(name);
  if (page.result.ablations.count("best preset") > 0) names.insert(names.begin(), "best preset");
  for (const std::string& name : names) {
    const auto& tasks = page.result.ablations.at(name);
    const runs::PooledErrors *point = find(tasks, "point"), *square = find(tasks, "square");
    if (point == nullptr || square == nullptr) continue;
    if (point->n_trials < kEnoughTrials || point->origin.n_seeds < kEnoughSeeds) ++few;
    table.cells.push_back({name, error_text(*point), success_text(*point), error_text(*square),
                           success_text(*square), std::to_string(point->n_trials),
                           seeds_text(point->origin)});
  }
  if (table.cells.empty()) return;
  const std::string warning =
      few == 0
          ? ""
          : std::to_string(few) + " of these rows have fewer than " + std::to_string(kEnoughTrials) +
                " trials or " + std::to_string(kEnoughSeeds) + " seeds: no sentence can be built on them.";
  page.markdown += "Ablations of our TD3, random target\n\n" + (warning.empty() ? "" : warning + "\n\n") +
                   table.markdown() + "\n";
  page.html.add_section("ablations", "Ablations",
                        "<p>Each row changes one thing, and is trained as long as the row named best preset. "
                        "Unseen rigs, by camera, bare. " +
                            escape(warning) + "</p>" + table.html());
}

}  // namespace lodestone::report
