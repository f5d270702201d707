#include <utility>

#include "lodestone/report/html.h"
#include "paper_page.h"

namespace lodestone::report {
namespace {

/// Difference of the final returns over the seeds that both have.
std::string difference_text(const runs::TrainingDifference& d) {
  const std::string seeds = d.n_seeds == 1 ? "1 seed" : std::to_string(d.n_seeds) + " seeds";
  if (!d.final_return_interval) return formatted("%+.2f", d.final_return) + " (" + seeds + ")";
  return formatted("%+.2f (%+.2f to %+.2f, ", d.final_return, (*d.final_return_interval)[0],
                   (*d.final_return_interval)[1]) +
         seeds + ")";
}

/// What a mix changes, as far as its seeds tell it apart from none.
std::string told(const std::string& name, const runs::TrainingDifference& mix) {
  const auto [low, high] = *mix.final_return_interval;
  std::string text = name + ": the final return is " +
                     (high < 0.0  ? "lower"
                      : low > 0.0 ? "higher"
                                  : "not told apart") +
                     formatted(" (%+.2f, %+.2f to %+.2f)", mix.final_return, low, high) +
                     formatted(", it scatters by %.3f instead of %.3f at the end", mix.unsteadiness,
                               mix.unsteadiness_of_other);
  if (mix.steps_to_maximum && mix.steps_to_maximum_of_other)
    text += ", and its maximum comes after " + grouped(*mix.steps_to_maximum) + " steps instead of " +
            grouped(*mix.steps_to_maximum_of_other);
  return text + ". ";
}

/// What became of the paper's collapse, and why as far as that is known.
std::string collapse(const runs::PooledTraining& alone) {
  const std::string seeds = std::to_string(alone.n_fallen) + " of " + std::to_string(alone.origin.n_seeds);
  const std::string text =
      "Nothing but recorded steps fell back in " + seeds + " seeds; in the paper it collapses. ";
  if (alone.n_fallen == alone.origin.n_seeds) return text;
  return text +
         "Our reading of where it did not, which no cell tests: these recorded pulses were made to go "
         "where the needle had seldom been and to do what had seldom been done there, and the operator "
         "put it anywhere, so that nearly all that a policy comes to want has been tried. ";
}

/// How coarse steps to the maximum are.
std::string between_evaluations(const PaperPage& page) {
  if (find(page.result.mixes, "0") == nullptr) return "";
  const std::vector<double>& steps = page.by_id.at("mix/0")->found.front().second->curve->env_steps;
  if (steps.size() < 2) return "";
  return "Evaluations lie " + grouped(steps[1] - steps[0]) +
         " steps apart: which mix learns faster by less than that is not told. ";
}

std::string order(const PaperPage& page) {
  std::string text =
      "In the paper, some recorded steps make learning a little faster and less steady, and nothing but "
      "recorded steps (its mix d, 3 of 3) collapses before it has taught enough. ";
  std::string ours;
  std::size_t compared = 0;
  for (const auto& [k, mix] : page.result.mix_differences) {
    if (mix.n_seeds < kEnoughSeeds) continue;
    ours += told(k + " of 3 replay", mix);
    ++compared;
  }
  if (!ours.empty())
    text += "Here, against equal trainings of the same seeds without recorded steps: " + ours;
  const auto alone = page.result.mixes.find("3");
  if (alone != page.result.mixes.end() && alone->second.origin.n_seeds >= kEnoughSeeds)
    text += collapse(alone->second);
  if (compared < 3)
    text += "Where a mix has fewer than " + std::to_string(kEnoughSeeds) +
            " training seeds, nothing is said here of how it compares.";
  return text;
}

}  // namespace

void add_mixes(PaperPage& page) {
  PaperTable table{{"environments that replay", "final return", "from 0 of 3, same seeds",
                    "scatter at the end", "steps to maximum", "seeds that fell back",
                    "success of the best policy in the MBS", "steps", "seeds", "precision"}};
  table.text_columns = 1;
  std::vector<std::pair<std::string, std::string>> lines;
  for (const auto& [k, name] : {std::pair<const char*, const char*>{"0", "0 of 3"},
                                {"1", "1 of 3"},
                                {"2", "2 of 3"},
                                {"3", "3 of 3, nothing but recorded steps"},
                                {"offline", "nothing but recorded steps, our learner and task"}}) {
    const std::string prefix = std::string("mix/") + k;
    if (!page.planned(prefix)) continue;
    if (std::string(k) != "offline") lines.emplace_back(name, prefix);
    const runs::PooledTraining* f = find(page.result.mixes, k);
    if (f == nullptr) {
      table.add_missing({name});
      continue;
    }
    const runs::TrainingDifference* from_none = find(page.result.mix_differences, k);
    table.cells.push_back(
        {name, with_interval("%.2f", f->final_return, f->final_return_interval),
         from_none != nullptr ? difference_text(*from_none) : "–",
         with_interval("%.3f", f->unsteadiness, f->unsteadiness_range), steps_to_maximum_text(*f),
         std::to_string(f->n_fallen) + " of " + std::to_string(f->origin.n_seeds), success_text(*f),
         grouped(f->env_steps), seeds_text(f->origin), joined(f->products)});
    table.add_commits(f->origin);
  }
  if (table.cells.empty()) return;
  page.add_part(
      "mixes", "Fig. 5, mixes with recorded pseudo-episodes",
      "Of the paper's three environments, so many play back recorded stretches of 10 to 15 steps, towards "
      "the centre, for as many steps as the table says. Evaluated in the MBS, without them. From 0 of 3: of "
      "the same seeds, which learn in the same simulators (though some in another precision of matrix "
      "products: see the column). Intervals are 95 %, by Student's t over seeds; rows of other numbers of "
      "seeds are not comparable otherwise. Scatter: standard deviation of the last fifth of the evaluations "
      "of a training; its, and those of steps to maximum and success (see Table I), are the mean, and the "
      "lowest and highest seed. Fell back: the last five evaluations are more than 5 % of the rise below "
      "the maximum. "
      "The best policy is the one that is kept, the final return that of the last. The last row has another "
      "learner, task and number of steps: its return does not compare with the others'. " +
          between_evaluations(page) + order(page),
      {{"", table}},
      figure(page.return_chart("fig5", "Return over steps", lines),
             "<b>Fig. 5.</b> Mean over seeds, dashed two standard deviations around it."));
}

}  // namespace lodestone::report
