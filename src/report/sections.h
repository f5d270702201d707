#pragma once

#include <optional>
#include <string>

#include "lodestone/report/dish_svg.h"
#include "lodestone/report/run_data.h"

namespace lodestone::report {

// Ready HTML of each section. `prefix` keeps the names of charts unique where a section stands twice on a
// page.

std::string overview_section(const RunData& run, const RunData* recorded);
std::string collection_section(const RunData& run);
std::string dynamics_section(const RunData& run, const std::string& prefix);
/// Of a policy, or of what poses cost with the policy that was learned beside it.
std::string policy_section(const StepData& policy, const std::optional<runs::PolicyResult>& trained,
                           const std::string& prefix);
std::string deployment_section(const RunData& run);
/// The trials one by one: errors over time and their distribution, the worst ones, currents and temperatures.
std::string trials_section(const RunData& run);
/// What the camera saw; only where trials were filmed.
std::string camera_section(const RunData& run);
/// Dynamics and policy learned from real recordings, beside the virtual rig's.
std::string recorded_section(const RunData& run, const RunData& recorded);

/// The rig of a configuration as drawings show it; the paper's where it does not tell.
DrawnRig drawn_rig_of(const common::Json& config);
/// The rig of a run as drawings show it; the paper's where the run does not tell.
DrawnRig drawn_rig(const RunData& run);

}  // namespace lodestone::report
