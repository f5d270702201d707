#include "lodestone/report/charts.h"
#include "lodestone/report/html.h"
#include "lodestone/runs/curves.h"
#include "sections.h"

namespace lodestone::report {
namespace {

struct Panel {
  const char* id;
  const char* title;
  const char* y_label;
  std::vector<LineSeries> series;
};

std::string panel_html(const Panel& panel, const std::string& prefix) {
  LineChart chart{prefix + "-" + panel.id, panel.title, "environment steps", panel.y_label};
  chart.small = true;
  for (const LineSeries& series : panel.series)
    if (!series.points.empty()) chart.series.push_back(series);
  return chart.series.empty() ? "" : "<figure>" + chart_html(chart) + "</figure>";
}

std::string result_sentence(const std::optional<runs::PolicyResult>& trained) {
  if (!trained) return "";
  const runs::PolicyFacts& facts = *trained;
  const auto steps = static_cast<double>(facts.env_steps);
  std::string text = "<p>" + grouped(steps) + " environment steps and " +
                     grouped(static_cast<double>(facts.updates)) + " updates in " +
                     grouped(facts.train_seconds) + " s";
  if (facts.train_seconds > 0.0) text += " (" + grouped(steps / facts.train_seconds) + " steps/s)";
  return text + ".</p>\n";
}

bool learns_cost_to_go(const StepData& policy) {
  return policy.config.is_object() && policy.config.value("method", "") == "value_iteration";
}

std::string score_sentence(const StepData& policy, const std::optional<runs::PolicyResult>& trained,
                           const Curve& evaluated) {
  if (trained && trained->fresh_evaluation) {
    const runs::PolicyScore& score = *trained->fresh_evaluation;
    return "<p>" +
           std::string(learns_cost_to_go(policy)
                           ? "What it costs to come to a pose is kept, for the planner, and with it the "
                             "policy of that time, learned in "
                           : "The policy that was kept is the best of all evaluations, reached after ") +
           grouped(static_cast<double>(trained->best_env_steps)) + " environment steps. In " +
           grouped(static_cast<double>(score.episodes)) +
           " fresh episodes of the simulator, which nothing was chosen by, " +
           (learns_cost_to_go(policy) ? "the policy brought <b>" : "<b>") + percent(score.success_rate) +
           (learns_cost_to_go(policy) ? "</b> to their pose.</p>\n" : "</b> reached their target.</p>\n");
  }
  if (evaluated.empty()) return "";
  return "<p>At the last evaluation, on a fixed set of starts and targets in the learned simulator, <b>" +
         percent(evaluated.back().second) + "</b> of the episodes reached their target.</p>\n";
}

}  // namespace

std::string policy_section(const StepData& policy, const std::optional<runs::PolicyResult>& trained,
                           const std::string& prefix) {
  const std::string command =
      "lodestone train-policy --set dynamics=RUN/dynamics/checkpoint --out RUN/" + policy.name;
  if (!policy.present() && !trained) return missing("The policy", command);
  const auto of = [&policy](const char* name) { return curve(policy.metrics, name); };
  const Curve evaluated = of(runs::curves::kSuccess);
  const std::vector<Panel> panels = {
      {"return",
       "Episode return",
       "return",
       {{"evaluation", of(runs::curves::kReturn), kPolicyColour},
        {"training, with noise", of(runs::curves::kTrainReturn), kUnseenColour}}},
      {"success",
       "Episodes that reach the target",
       "fraction of episodes",
       {{"evaluation", evaluated, kPolicyColour},
        {"training, with noise", of(runs::curves::kTrainSuccess), kUnseenColour}}},
      {"error",
       "Distance at the end of an episode",
       "distance (mm)",
       {{"mean", of(runs::curves::kEpisodeEndError), kPolicyColour},
        {"median", of(runs::curves::kEpisodeEndErrorMedian), kUnseenColour}}},
      {"q", "Mean Q value", "return expected", {{"Q", of(runs::curves::kQ), kSecondColour}}},
      {"losses",
       "Losses",
       "loss",
       {{"critic", of(runs::curves::kCriticLoss), kBaselineColour},
        {"actor", of(runs::curves::kActorLoss), kSecondColour}}},
      {"saturation",
       "Actions at their limit",
       "fraction of components",
       {{"training", of(runs::curves::kTrainSaturation), kSecondColour},
        {"evaluation", of(runs::curves::kSaturation), kPolicyColour}}},
  };
  std::string charts;
  for (const Panel& panel : panels) charts += panel_html(panel, prefix);
  std::string html = result_sentence(trained);
  if (charts.empty()) return html + missing("The log of its training (metrics.jsonl)", command);
  html += score_sentence(policy, trained, evaluated);
  return html + "<div class=\"three\">" + charts +
         "</div>\n<p class=\"subtitle\">Evaluation runs without exploration noise, in the same episodes each "
         "time. An episode ends at the first arrival at its target, or when its steps are used up; a "
         "deployment goes on, and its errors are those after a fixed time." +
         (of(runs::curves::kQ).empty()
              ? std::string(learns_cost_to_go(policy)
                                ? " The critic's loss is that of the cost, as a share of the most that it "
                                  "can be; the actor's says how unlike the planner's its pulses are."
                                : " The actor's loss is the distance in mm that it expects after a pulse.")
              : " Q values should level off near the returns seen; losses alone say little about the "
                "policy.") +
         "</p>\n";
}

}  // namespace lodestone::report
