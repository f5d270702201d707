#pragma once

#include "verb.h"

namespace lodestone::apps {

/// The verbs `cancel` and `logs` of the runs of a plan, of whatever verb has given it, by their folder.
void add_plan_folder(Verb& verb);

}  // namespace lodestone::apps
