#include "lodestone/report/report.h"

#include <filesystem>

#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "lodestone/report/error_table.h"
#include "lodestone/report/html_page.h"
#include "sections.h"
#include "trial_drawing.h"

namespace lodestone::report {

constexpr double kPaperDishRadius_mm = 42.5;

double dish_radius_mm(const RunData& run) {
  return run.coverage && run.coverage->workspace_radius_m > 0.0 ? 1000.0 * run.coverage->workspace_radius_m
                                                                : kPaperDishRadius_mm;
}

std::string report_html(const RunData& run, const std::optional<RunData>& recorded) {
  HtmlPage page("Lodestone: a learned controller for a magnetic rig",
                run.deployment_only ? "What one deployment measured"
                                    : "From exploration to a learned simulator, to a controller, to the rig");
  page.add_section("overview", "What was run", overview_section(run, recorded ? &*recorded : nullptr));
  if (!run.deployment_only) {
    page.add_section("collection", "Exploration", collection_section(run));
    page.add_section("dynamics", "Learned simulator", dynamics_section(run, "dynamics"));
    page.add_section("policy", "Policy", policy_section(run, "policy"));
  }
  page.add_section("deployment", "On the rig", deployment_section(run));
  if (!run.rigs.empty()) page.add_section("trials", "Trial by trial", trials_section(run));
  if (!run.filmed.empty()) page.add_section("camera", "What the camera saw", camera_section(run));
  if (recorded) page.add_section("recorded", "Real recordings", recorded_section(run, *recorded));
  return page.render();
}

/// The trajectories of the page as files: images/RIG_CONTROLLER_TASK.svg.
void write_images(const RunData& run) {
  for (const DeployData& rig : run.rigs) {
    const std::vector<Trial> trials = read_trials(rig);
    for (const std::string& controller : controllers_of(trials))
      for (const char* task : runs::kTasks)
        write_svg(run.folder + "/images/" + rig.rig + "_" + controller + "_" + task + ".svg",
                  draw_trials(select(trials, task, controller), dish_radius_mm(run),
                              std::string("Trajectories: ") + task + ", " + controller));
  }
}

void write_report(const std::string& run_folder, const std::string& recorded_folder, const std::string& out) {
  const RunData run = read_run(run_folder);
  std::optional<RunData> recorded;
  if (!recorded_folder.empty()) recorded = read_run(recorded_folder);
  const std::string folder = std::filesystem::path(out).parent_path().string();
  if (!folder.empty()) common::make_folders(folder);
  common::write_file_atomically(out, report_html(run, recorded));
  // The folder of a deployment holds a summary of its own.
  if (!run.deployment_only)
    common::write_artefact(run_folder + "/" + runs::DeploymentSummary::kFile, merged_summary(run));
  common::write_file_atomically(run_folder + "/table.txt", error_table_text(error_rows(run)));
  write_images(run);
}

}  // namespace lodestone::report
