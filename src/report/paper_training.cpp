#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>

#include "lodestone/report/html.h"
#include "paper_page.h"

namespace lodestone::report {
namespace {

/// What the columns of trainings that were alone rest on.
std::string alone_text(const PaperPage& page) {
  std::vector<std::string> commits, processors, products;
  double least_share = 1.0, most_others = 0.0;
  std::size_t count = 0;
  for (const auto& [row, tasks] : page.result.paces)
    for (const auto& [task, pace] : tasks) {
      ++count;
      add_new(commits, pace.origin.commits);
      add_new(processors, pace.origin.processors);
      add_new(products, pace.products);
      least_share = std::min(least_share, pace.processor_share);
      most_others = std::max(most_others, pace.others.value_or(0.0));
    }
  if (count == 0) return "Alone: not measured yet (bench paper --pace).";
  return "Alone: at the pace, once warm, of " + std::to_string(count) +
         " trainings that were begun one after another, on one thread with nothing beside it, in simulators "
         "of the same size learned in an epoch from 2,000 pulses (bench paper --pace; " +
         joined(processors) + "; " + joined(products) + "; commits " + joined(commits) +
         formatted("), of which each had at least %.0f %% of a processor; others kept at most %.2f busy.",
                   100.0 * least_share, most_others);
}

constexpr double kRigRate_hz = 3.0;  // the paper's, section V-B

}  // namespace

void add_training(PaperPage& page) {
  struct Trained {
    const char *row, *task, *name, *published;
  };
  PaperTable table{{"policy", "paper: time to maximum", "steps", "steps to maximum", "steps/s, alone",
                    "times the rig's 3 Hz", "time to maximum (s), alone", "as it ran (s)",
                    "whole training (s), alone", "as it ran (s)", "success in its own simulator",
                    "within (mm)", "timed seeds", "seeds that had converged", "precision", "processor"}};
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
    const auto* paces = find(page.result.paces, t.row);
    const runs::TrainingPace* pace = paces != nullptr ? find(*paces, t.task) : nullptr;
    const auto alone_s = [pace](const std::optional<double>& steps) {
      return pace != nullptr && steps ? std::optional(pace->seconds_to(*steps)) : std::nullopt;
    };
    std::optional<std::array<double, 2>> alone_range_s;
    if (const auto& steps = f->steps_to_maximum_range; pace != nullptr && steps)
      alone_range_s = {pace->seconds_to((*steps)[0]), pace->seconds_to((*steps)[1])};
    table.cells.push_back({t.name, t.published, grouped(f->env_steps), steps_to_maximum_text(*f),
                           pace != nullptr ? grouped(pace->steps_per_s) : "–",
                           pace != nullptr ? grouped(pace->steps_per_s / kRigRate_hz) : "–",
                           with_interval("%.0f", alone_s(f->steps_to_maximum), alone_range_s),
                           or_dash("%.0f", f->seconds_to_maximum), or_dash("%.0f", alone_s(f->env_steps)),
                           or_dash("%.0f", f->train_seconds), success_text(*f),
                           or_dash("%.0f", f->success_radius_mm), std::to_string(f->n_timed),
                           std::to_string(f->n_converged) + " of " + std::to_string(f->origin.n_seeds) +
                               ", " + std::to_string(f->origin.n_seeds_planned) + " planned",
                           f->products.empty() ? "–" : joined(f->products), joined(f->origin.processors)});
    table.add_commits(f->origin);
    if (pace != nullptr) table.add_commits(pace->origin);
    charts += page.return_chart(std::string("fig4-") + t.row + "-" + t.task, t.name, {{t.name, prefix}});
  }
  if (table.cells.empty()) return;
  page.add_part(
      "training", "Table I and Fig. 4, training",
      "Seconds include evaluations. " + alone_text(page) +
          " As it ran: of the seeds that had one thread, on whatever processor, beside other cells, so that "
          "it does not compare rows; a dash stands where none had. To the maximum: until the return of "
          "evaluations in its own simulator was within 5 % of its rise of its maximum, and stayed there "
          "over five evaluations; given only where no seed's return rose by more than that in its last "
          "fifth, and no finer than evaluations lie apart (one at the first evaluation may have been "
          "earlier). Means over seeds, of steps, their time alone and success with the lowest and the "
          "highest of them where they differ. Success is that of each row's own task: within what distance, "
          "on what share of the dish and in how many steps differ between the paper's rows, our TD3's and "
          "the gradient's, so that it does not compare them. The paper's hours are its Table I, on its own "
          "machine. It says that its MBS took 700 steps/s in three environments, 233 times as many as its "
          "rig (3 Hz); ours include learning, in the rows as the paper's an update a step, and bench speed "
          "measures how many the MBS takes without. Precision: of the matrix products of TD3, bfloat16 "
          "where a processor is faster so; the seeds of a row may differ in it. Fig. 4, returns over steps, "
          "is drawn on the page that bench paper writes.",
      {{"", table}},
      figure("<div class=\"two\">" + charts + "</div>",
             "<b>Fig. 4.</b> Return of fixed evaluation episodes in the simulator that the policy "
             "learns in: mean over seeds, dashed two standard deviations around it."));
}

}  // namespace lodestone::report
