#pragma once

#include "lodestone/control/sensing.h"

namespace lodestone::apps {

/// Names the segmenter that is shipped (models/segmenter: in the working folder, the source tree this program
/// was built in, or where it is installed) when a camera is used and none is named. Throws ConfigError when
/// there is none.
void choose_segmenter(control::SensingConfig& sensor);

}  // namespace lodestone::apps
