#include "lodestone/common/config_layers.h"

namespace lodestone::common {

void ConfigLayers::add_file(const std::string& path, const std::string& under) {
  add(read_json_file(path), path, under);
}

void ConfigLayers::add(Json content, const std::string& path, const std::string& under) {
  if (!under.empty()) content = Json{{under, std::move(content)}};
  merge(json_, content, "", path);
}

void ConfigLayers::set(const std::string& assignment, const std::string& option) {
  apply_override(json_, assignment);  // checks the path against what is there
  Json given = Json::object();
  apply_override(given, assignment);
  merge(json_, given, "", option);
}

void ConfigLayers::merge(Json& into, const Json& from, const std::string& path, const std::string& source) {
  if (into.is_object() && from.is_object()) {
    for (const auto& [key, value] : from.items())
      merge(into[key], value, path.empty() ? key : path + "." + key, source);
    return;
  }
  const std::string below = path + ".";
  for (auto it = by_path_.lower_bound(below);
       it != by_path_.end() && it->first.compare(0, below.size(), below) == 0;)
    it = by_path_.erase(it);
  into = from;
  if (!from.is_object()) {
    by_path_[path] = source;
    return;
  }
  for (const auto& [key, value] : from.items()) merge(into[key], value, below + key, source);
}

}  // namespace lodestone::common
