#pragma once

#include <map>
#include <string>

namespace lodestone::apps {

/// The command that usually follows a verb that succeeded ("collect", "rig check"), with what it wrote filled
/// in; empty where nothing in particular follows. `given`: options of the verb ("--out") and keys of its
/// configuration ("task.goal"), with their values.
std::string next_step(const std::string& verb, const std::map<std::string, std::string>& given);

}  // namespace lodestone::apps
