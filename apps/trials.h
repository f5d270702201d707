#pragma once

#include "common_options.h"
#include "lodestone/experiments/deployment_job.h"
#include "lodestone/runs/deployment_results.h"

namespace lodestone::apps {

/// What verbs that drive trials take: which tasks, on which rigs, with what.
void add_trials_options(Verb& verb, CommonOptions& options);

/// What came of a deployment, a line for each task, controller and kind of rig.
void print_deployment(const experiments::DeploymentJob& job, const runs::DeploymentSummary& summary);

}  // namespace lodestone::apps
