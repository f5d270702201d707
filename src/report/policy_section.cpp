#include "lodestone/report/charts.h"
#include "lodestone/report/html.h"
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
  LineChart chart;
  chart.id = prefix + "-" + panel.id;
  chart.title = panel.title;
  chart.x_label = "environment steps";
  chart.y_label = panel.y_label;
  chart.small = true;
  for (const LineSeries& series : panel.series)
    if (!series.points.empty()) chart.series.push_back(series);
  return chart.series.empty() ? "" : "<figure>" + chart_html(chart) + "</figure>";
}

std::string result_sentence(const RunData& run) {
  const auto steps = number_at(run.policy.result, {"env_steps"});
  const auto updates = number_at(run.policy.result, {"updates"});
  const auto seconds = number_at(run.policy.result, {"train_seconds"});
  if (!steps && !updates) return "";
  std::string text = "<p>" + (steps ? grouped(*steps) : std::string("–")) + " environment steps and " +
                     (updates ? grouped(*updates) : std::string("–")) + " updates";
  if (seconds) {
    text += " in " + grouped(*seconds) + " s";
    if (steps && *seconds > 0.0) text += " (" + grouped(*steps / *seconds) + " steps/s)";
  }
  return text + ".</p>\n";
}

}  // namespace

std::string policy_section(const RunData& run, const std::string& prefix) {
  const std::string command =
      "lodestone train-policy --set dynamics=RUN/dynamics/checkpoint --out RUN/policy";
  if (!run.policy.present()) return missing("The policy", command);
  const auto of = [&run](std::initializer_list<const char*> keys) { return curve(run.policy.metrics, keys); };
  const Curve evaluated = of({"evaluation/success_rate"});
  const std::vector<Panel> panels = {
      {"return",
       "Episode return",
       "return",
       {{"evaluation", of({"evaluation/return", "evaluation/episode_return"}), kPolicyColour, false},
        {"training, with noise", of({"train/return", "train/episode_return"}), kUnseenColour, false}}},
      {"success",
       "Episodes that reach the target",
       "fraction of episodes",
       {{"evaluation", evaluated, kPolicyColour, false},
        {"training, with noise", of({"train/success_rate"}), kUnseenColour, false}}},
      {"error",
       "Distance at the end of an episode",
       "distance (mm)",
       {{"mean", of({"evaluation/final_error_mm"}), kPolicyColour, false},
        {"median", of({"evaluation/final_error_median_mm"}), kUnseenColour, false}}},
      {"q", "Mean Q value", "return expected", {{"Q", of({"train/q_mean"}), kSecondColour, false}}},
      {"losses",
       "Losses",
       "loss",
       {{"critic", of({"train/critic_loss"}), kBaselineColour, false},
        {"actor", of({"train/actor_loss"}), kSecondColour, false}}},
      {"saturation",
       "Actions at their limit",
       "fraction of components",
       {{"training", of({"train/saturation", "train/action_saturation"}), kSecondColour, false},
        {"evaluation", of({"evaluation/action_saturation", "evaluation/saturation"}), kPolicyColour, false}}},
  };
  std::string charts;
  for (const Panel& panel : panels) charts += panel_html(panel, prefix);
  std::string html = result_sentence(run);
  if (charts.empty()) return html + missing("The log of the policy's training (metrics.jsonl)", command);
  if (!evaluated.empty())
    html += "<p>At the last evaluation, on a fixed set of starts and targets in the learned simulator, <b>" +
            percent(evaluated.back().second) + "</b> of the episodes reached their target.</p>\n";
  return html + "<div class=\"three\">" + charts +
         "</div>\n<p class=\"subtitle\">Evaluation runs without exploration noise. Q values should level off "
         "near the "
         "returns seen; losses alone say little about the policy.</p>\n";
}

}  // namespace lodestone::report
