#pragma once

#include <string>

#include "lodestone/session/sensing.h"

namespace lodestone::apps {

/// "models" or "configs" as they are shipped: in the working folder, the source tree this program was built
/// in, or where it is installed. Throws ConfigError when there is none.
std::string shipped_folder(const std::string& name);

/// Names the segmenter that is shipped (models/segmenter) when a camera is used and none is named. Throws
/// ConfigError when there is none.
void choose_segmenter(session::SensingConfig& sensor);

/// Path of this program, for the processes that a plan starts.
std::string own_path();

}  // namespace lodestone::apps
