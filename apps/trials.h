#pragma once

#include "common_options.h"
#include "lodestone/experiments/deployment_job.h"
#include "lodestone/experiments/trial_recording.h"
#include "lodestone/runs/deployment_results.h"
#include "lodestone/runs/run_folder.h"

namespace lodestone::apps {

/// What verbs that drive trials take: which tasks, on which rigs, with what.
void add_trials_options(Verb& verb, CommonOptions& options);

/// Those of a run for films and logs, where they are asked for. Throws IoError.
experiments::TrialFolders make_trial_folders(const experiments::DeployConfig& config,
                                             const runs::RunFolder& run);

/// What came of a deployment, a line for each task, controller and kind of rig.
void print_deployment(const experiments::DeploymentJob& job, const runs::DeploymentSummary& summary);

}  // namespace lodestone::apps
