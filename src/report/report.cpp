#include "lodestone/report/report.h"

#include <cmath>
#include <filesystem>

#include "lodestone/common/artefact.h"
#include "lodestone/common/files.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/report/error_table.h"
#include "lodestone/report/html_page.h"
#include "sections.h"
#include "trial_drawing.h"

namespace lodestone::report {

constexpr double kPaperDishRadius_mm = 42.5;
constexpr double kBelow_m = 1e-3;

DrawnRig drawn_rig_of(const common::Json& config) {
  DrawnRig drawn(kPaperDishRadius_mm);
  try {
    const common::Json& rig = config.at("rig");
    drawn.radius_mm = 1e3 * rig.at("dish").at("radius_m").get<double>();
    const common::Json each = rig.at("coils").value("each", common::Json::array());
    if (!each.empty()) drawn.coils.clear();
    for (const common::Json& coil : each) {
      const double x_m = coil.at("position_m").at(0).get<double>();
      const double y_m = coil.at("position_m").at(1).get<double>();
      if (std::hypot(x_m, y_m) < kBelow_m) continue;  // above or below the dish
      drawn.coils.push_back(
          {coil.at("name").get<std::string>(), geometry::kDegPerRad * std::atan2(y_m, x_m)});
    }
    const common::Json safety = config.value("safety", common::Json::object());
    for (const common::Json& zone : safety.value("keep_out", common::Json::array())) {
      DrawnZone& shown = drawn.keep_out.emplace_back();
      shown.radius_mm = 1e3 * zone.at("radius_m").get<double>();
      const auto corners_m = zone.at("corners_m").get<std::vector<double>>();
      for (std::size_t i = 0; i + 1 < corners_m.size(); i += 2)
        shown.corners_mm.emplace_back(1e3 * corners_m[i], 1e3 * corners_m[i + 1]);
    }
    return drawn;
  } catch (const common::Json::exception&) {
    return DrawnRig(kPaperDishRadius_mm);  // no run, or one of an earlier version, which told less
  }
}

DrawnRig drawn_rig(const RunData& run) {
  const bool deployed = run.deploy.config.is_object() && run.deploy.config.contains("rig");
  DrawnRig drawn = drawn_rig_of(deployed ? run.deploy.config : run.collect.config);
  if (run.coverage && run.coverage->workspace_radius_m > 0.0)
    drawn.radius_mm = 1e3 * run.coverage->workspace_radius_m;
  return drawn;
}

std::string report_html(const RunData& run, const std::optional<RunData>& recorded) {
  HtmlPage page("Lodestone: a learned controller for a magnetic rig",
                run.deployment_only ? "What one deployment measured"
                                    : "From exploration to a learned simulator, to a controller, to the rig");
  page.add_section("overview", "What was run", overview_section(run, recorded ? &*recorded : nullptr));
  if (!run.deployment_only) {
    page.add_section("collection", "Exploration", collection_section(run));
    page.add_section("dynamics", "Learned simulator", dynamics_section(run, "dynamics"));
    if (run.policy.present() || !run.cost_to_go.present())
      page.add_section("policy", "Policy", policy_section(run.policy, run.trained, "policy"));
    if (run.cost_to_go.present())
      page.add_section("cost-to-go", "What poses cost",
                       policy_section(run.cost_to_go, run.cost_to_go_trained, "cost-to-go"));
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
                  draw_trials(select(trials, task, controller), drawn_rig(run),
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
