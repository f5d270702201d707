#pragma once

#include <functional>
#include <string>

namespace lodestone::apps {

/// The command that usually follows a verb that succeeded ("collect", "rig check"), with what it wrote filled
/// in; empty where nothing in particular follows. `option` gives the value of an option of the verb
/// ("--out"), empty when it was not given.
std::string next_step(const std::string& verb, const std::function<std::string(const std::string&)>& option);

}  // namespace lodestone::apps
