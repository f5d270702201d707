#include <initializer_list>

#include "lodestone/report/html.h"
#include "paper_page.h"

namespace lodestone::report {

void add_training(PaperPage& page) {
  struct Trained {
    const char *row, *task, *name, *published;
  };
  PaperTable table{{"policy", "paper: time to maximum", "steps", "time to maximum (s)",
                    "of the processor (s)", "whole training (s)", "of the processor (s)",
                    "steps/s of the processor", "success in its own simulator", "seeds that had converged"}};
  std::string charts;
  for (const Trained& t : std::initializer_list<Trained>{
           {"paper", "centre", "as the paper's, MBS, centre", "1.5 h"},
           {"paper", "target", "as the paper's, MBS, random target", "3.5 h"},
           {"paper_simulator", "centre", "as the paper's, plain simulator, centre", "5.5 h"},
           {"paper_simulator", "target", "as the paper's, plain simulator, random target", "27 h"},
           {"best", "centre", "our TD3, MBS, centre", "–"},
           {"best", "target", "our TD3, MBS, random target", "–"},
           {"simulator", "centre", "our TD3, plain simulator, centre", "–"},
           {"simulator", "target", "our TD3, plain simulator, random target", "–"},
           {"randomised", "centre", "our TD3, randomised simulator, centre", "–"},
           {"randomised", "target", "our TD3, randomised simulator, random target", "–"},
           {"any_rig", "target", "down our MBS' gradient, random target", "–"}}) {
    const std::string prefix = std::string("policy/") + t.row + "/" + t.task;
    if (!page.planned(prefix)) continue;
    const auto* of_row = find(page.result.training, t.row);
    const runs::PooledTraining* f = of_row != nullptr ? find(*of_row, t.task) : nullptr;
    if (f == nullptr) {
      table.add_missing({t.name, t.published});
      continue;
    }
    table.cells.push_back({t.name, t.published, text_of("%.0f", f->env_steps),
                           f->steps_to_maximum ? or_dash("%.0f", f->seconds_to_maximum) : "had not converged",
                           or_dash("%.0f", f->processor_seconds_to_maximum),
                           or_dash("%.0f", f->train_seconds), or_dash("%.0f", f->processor_seconds),
                           f->processor_seconds ? text_of("%.0f", f->env_steps / *f->processor_seconds) : "–",
                           text_of("%.0f %%", 100.0 * f->success_rate),
                           std::to_string(f->n_converged) + " of " + std::to_string(f->origin.n_seeds)});
    charts += page.return_chart(std::string("fig4-") + t.row + "-" + t.task, t.name, {{t.name, prefix}});
  }
  if (table.cells.empty()) return;
  page.markdown += "Table I, training; seconds are of seeds on one thread\n\n" + table.markdown() + "\n";
  page.html.add_section(
      "training", "Table I and Fig. 4: training",
      "<p>Seconds are those of seeds that had one thread, evaluations included, on the clock and of the "
      "processor: the clock also counts what "
      "other cells and programs took of "
      "the machine meanwhile. Time to maximum: until the evaluation return, smoothed over five "
      "evaluations, was within 5 % of its rise below "
      "its maximum; given only where no seed's return rose by more than that in its last fifth. The "
      "paper's hours are its Table I, on its own "
      "machine, where three environments took 700 steps/s, 233 times as many as its rig (3 Hz).</p>" +
          table.html() +
          figure("<div class=\"two\">" + charts + "</div>",
                 "<b>Fig. 4.</b> Return of fixed evaluation episodes in the simulator that the policy "
                 "learns in: mean over seeds, dashed two standard deviations around it."));
}

}  // namespace lodestone::report
