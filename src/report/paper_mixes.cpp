#include "lodestone/report/html.h"
#include "paper_page.h"

namespace lodestone::report {
namespace {

/// What a mix changes, as far as its seeds tell it apart from none.
std::string told(const std::string& name, const runs::MixDifference& mix) {
  const auto [low, high] = mix.final_return_interval;
  std::string text =
      name + ": the final return is " +
      (high < 0.0  ? "lower"
       : low > 0.0 ? "higher"
                   : "not told apart") +
      text_of(" (%+.2f, %+.2f to %+.2f)", mix.final_return, low, high) +
      text_of(", it scatters by %.2f instead of %.2f at the end", mix.unsteadiness, mix.unsteadiness_without);
  if (mix.steps_to_maximum && mix.steps_to_maximum_without)
    text += ", and its maximum comes after " + grouped(*mix.steps_to_maximum) + " steps instead of " +
            grouped(*mix.steps_to_maximum_without);
  return text + ". ";
}

std::string order(const PaperPage& page) {
  std::string text =
      "In the paper, some recorded steps make learning a little faster and less steady, and recorded steps "
      "alone collapse before they have taught enough. ";
  std::string ours;
  std::size_t compared = 0;
  for (const auto& [k, mix] : page.result.mix_differences) {
    if (mix.n_seeds < kEnoughSeeds) continue;
    ours += told(k + " of 3 replay", mix);
    ++compared;
  }
  if (!ours.empty()) text += "Here, against an equal training without recorded steps: " + ours;
  if (compared < 3)
    text += "Where a mix has fewer than " + std::to_string(kEnoughSeeds) +
            " training seeds, nothing is said here of how it compares.";
  return text;
}

}  // namespace

void add_mixes(PaperPage& page) {
  PaperTable table{{"environments that replay", "final return", "scatter at the end", "steps to maximum",
                    "success in the MBS", "steps", "seeds"}};
  table.text_columns = 1;
  std::vector<std::pair<std::string, std::string>> lines;
  for (const char* k : {"0", "1", "2", "3", "offline"}) {
    const std::string prefix = std::string("mix/") + k;
    if (!page.planned(prefix)) continue;
    const bool offline = std::string(k) == "offline";
    const std::string name = offline ? "recorded steps alone, our learner" : std::string(k) + " of 3";
    if (!offline) lines.emplace_back(name, prefix);
    const runs::PooledTraining* f = find(page.result.mixes, k);
    if (f == nullptr) {
      table.add_missing({name});
      continue;
    }
    table.cells.push_back({name, text_of("%.2f", f->final_return), text_of("%.2f", f->unsteadiness),
                           f->steps_to_maximum ? grouped(*f->steps_to_maximum) : "had not converged",
                           text_of("%.0f %%", 100.0 * f->success_rate), text_of("%.0f", f->env_steps),
                           seeds_text(f->origin)});
  }
  if (table.cells.empty()) return;
  const std::string sentence = order(page);
  page.markdown +=
      "Fig. 5, mixes with recorded pseudo-episodes\n\n" + table.markdown() + "\n" + sentence + "\n\n";
  page.html.add_section(
      "mixes", "Fig. 5: off-policy mixes",
      "<p>Of the paper's three environments, so many play back recorded stretches of 10 to 15 steps. "
      "Evaluated in the MBS, without them. Scatter: standard deviation of the last fifth of the evaluations "
      "of a "
      "training; steps to maximum as in Table I.</p>" +
          table.html() + "<p>" + escape(sentence) + "</p>" +
          figure(page.return_chart("fig5", "Return over steps", lines),
                 "<b>Fig. 5.</b> Mean over seeds, dashed two standard deviations around it."));
}

}  // namespace lodestone::report
