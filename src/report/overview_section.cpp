#include <utility>

#include "lodestone/report/error_table.h"
#include "lodestone/report/html.h"
#include "lodestone/runs/run_folder.h"
#include "sections.h"

namespace lodestone::report {
namespace {

using common::Json;

std::string text_at(const Json& json, const char* key) {
  if (!json.is_object() || !json.contains(key)) return "–";
  const Json& value = json.at(key);
  return escape(value.is_string() ? value.get<std::string>() : value.dump());
}

std::string card(const std::string& value, const std::string& unit, const std::string& what) {
  return "<div class=\"card\"><div class=\"value\">" + value + " <span class=\"unit\">" + unit +
         "</span></div><div class=\"what\">" + what + "</div></div>";
}

std::string cards(const RunData& run) {
  std::string html;
  if (run.coverage)
    html += card(grouped(static_cast<double>(run.coverage->transitions)), "", "pulses recorded");
  if (run.evaluation)
    html += card(fixed(run.evaluation->one_step.position_rms_mm, 2), "mm RMS",
                 "one-step error of the learned simulator");
  if (run.trained)
    html += card(grouped(static_cast<double>(run.trained->env_steps)), "", "environment steps of training");
  for (const ErrorRow& row : error_rows(run)) {
    if (row.published || row.controller == "baseline" || row.rig != run.rigs.front().rig) continue;
    const bool path = row.task != "centre" && row.task != "point" && row.task != "pose";
    html += card(fixed(path ? row.rms_mm : row.mean_mm, 2), path ? "mm RMS" : "mm mean",
                 escape(row.task) + ", " + escape(row.rig) + " rig, " + escape(row.controller));
  }
  return html.empty() ? "" : "<div class=\"cards\">" + html + "</div>\n";
}

void add_steps(const RunData& run, const std::string& label, std::vector<std::vector<std::string>>& rows) {
  for (const StepData* step : {&run.collect, &run.dynamics, &run.policy, &run.cost_to_go, &run.deploy}) {
    const std::string seed = step->manifest.is_null() ? "" : text_at(step->manifest, "seed");
    std::string name = escape(label + step->name);
    for (const Json& m : runs::manifests_of(step->manifest)) {
      std::string commit = text_at(m, "git_commit");
      if (commit.size() > 12) commit.resize(12);
      rows.push_back({std::exchange(name, "… went on"), text_at(m, "time_utc"), "<code>" + commit + "</code>",
                      text_at(m, "host") + ", " + text_at(m, "processor"), seed, text_at(m, "threads")});
    }
  }
}

std::string configurations(const RunData& run, const std::string& label) {
  std::string html;
  for (const StepData* step : {&run.collect, &run.dynamics, &run.policy, &run.cost_to_go, &run.deploy})
    if (step->config.is_object())
      html += "<details><summary>" + escape(label + step->name) +
              ": every key of its configuration</summary><pre>" + escape(step->config.dump(2)) +
              "</pre></details>\n";
  return html;
}

}  // namespace

std::string overview_section(const RunData& run, const RunData* recorded) {
  std::string html;
  if (!run.deployment_only) {
    const bool planned = !run.rigs.empty() && run.rigs.front().driver() == "planner";
    const bool down =
        run.policy.config.is_object() && run.policy.config.value("method", "td3") == "model_gradient";
    html =
        std::string(
            "<p>The rig is explored and recorded; a network learns from the record what a pulse of "
            "the coils does (the model-based simulator, MBS); ") +
        (!run.policy.present() && run.cost_to_go.present() ? ""
         : down ? "a policy is trained down the gradient of what that simulator expects of a pulse; and "
                : "a policy is trained by TD3 in many copies of that simulator; and ") +
        (planned ? "a planner, which tries pulses in that simulator before it gives one, drives the rig" +
                       std::string(run.cost_to_go.present()
                                       ? "; where a target stays, by what was learned of the pulses that it "
                                         "takes from one pose to another."
                                       : ".")
                 : "the policy then drives the rig.") +
        " Every image below comes from the files of this run; a click shows it as large as the window.</p>\n";
  }
  html += cards(run);
  std::vector<std::vector<std::string>> rows;
  add_steps(run, "", rows);
  if (recorded != nullptr) add_steps(*recorded, "recorded: ", rows);
  if (rows.empty())
    html += missing("The manifest", "lodestone collect --out RUN/collect");
  else
    html += table({"step", "started (UTC)", "commit", "machine", "seed", "threads"}, rows, 4);
  html += configurations(run, "");
  if (recorded != nullptr) html += configurations(*recorded, "recorded: ");
  return html;
}

}  // namespace lodestone::report
