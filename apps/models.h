#pragma once

#include <string>

#include "common_options.h"
#include "lodestone/session/sensing.h"

namespace lodestone::apps {

/// "models" or "configs" as they are shipped: in the working folder, the source tree this program was built
/// in, or where it is installed. Throws ConfigError when there is none.
std::string shipped_folder(const std::string& name);

/// Names the segmenter that is shipped (models/segmenter) when a camera is used and none is named. Throws
/// ConfigError when there is none.
void choose_segmenter(session::SensingConfig& sensor);

/// Uses a released model: its folder is the policy or the simulator, its deploy.json comes before any
/// --config.
void use_models(CommonOptions& options, const std::string& folder);
/// --models
void add_models_option(Verb& verb, CommonOptions& options);
/// --models of a verb that drives to `points` beside other things: of the model's deploy.json it takes the
/// simulator and the decorators, as rig, loop and limits are the verb's own.
void add_points_models_option(Verb& verb, CommonOptions& options);

/// Path of this program, for the processes that a plan starts.
std::string own_path();

}  // namespace lodestone::apps
