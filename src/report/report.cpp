#include "lodestone/report/report.h"

#include "lodestone/common/files.h"
#include "lodestone/report/error_table.h"
#include "lodestone/report/html_page.h"
#include "sections.h"

namespace lodestone::report {

constexpr double kPaperDishRadius_mm = 42.5;

double dish_radius_mm(const RunData& run) {
  return run.coverage && run.coverage->workspace_radius_m > 0.0 ? 1000.0 * run.coverage->workspace_radius_m
                                                                : kPaperDishRadius_mm;
}

std::string report_html(const RunData& run, const std::optional<RunData>& recorded) {
  HtmlPage page("Lodestone: a learned controller for a magnetic rig",
                "From exploration to a learned simulator, to a policy, to the rig");
  page.add_section("overview", "What was run", overview_section(run, recorded ? &*recorded : nullptr));
  page.add_section("collection", "Exploration", collection_section(run));
  page.add_section("dynamics", "Learned simulator", dynamics_section(run, "dynamics"));
  page.add_section("policy", "Policy", policy_section(run, "policy"));
  page.add_section("deployment", "On the rig", deployment_section(run));
  if (!run.filmed.empty()) page.add_section("camera", "What the camera saw", camera_section(run));
  if (recorded) page.add_section("recorded", "Real recordings", recorded_section(run, *recorded));
  return page.render();
}

void write_report(const std::string& run_folder, const std::string& recorded_folder, const std::string& out) {
  const RunData run = read_run(run_folder);
  std::optional<RunData> recorded;
  if (!recorded_folder.empty()) recorded = read_run(recorded_folder);
  common::write_file_atomically(out, report_html(run, recorded));
  common::write_file_atomically(run_folder + "/summary.json", merged_summary(run).dump(1) + "\n");
  common::write_file_atomically(run_folder + "/table.txt", error_table_text(error_rows(run)));
}

}  // namespace lodestone::report
