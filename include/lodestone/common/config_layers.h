#pragma once

#include <map>
#include <string>

#include "lodestone/common/config.h"

namespace lodestone::common {

/// A configuration that comes together from files and options. Later ones win, key by key; where every value
/// came from is remembered.
class ConfigLayers {
 public:
  /// A JSON file; with `under`, its content stands below that key. Throws ConfigError.
  void add_file(const std::string& path, const std::string& under = "");
  /// The same, of a content that was read from there already.
  void add(Json content, const std::string& path, const std::string& under = "");
  /// Values given by an option of the command line, "a.b.c=value", read as apply_override() does.
  void set(const std::string& assignment, const std::string& option);

  const Json& json() const { return json_; }
  ConfigSources sources() const { return {"command line", by_path_}; }

 private:
  void merge(Json& into, const Json& from, const std::string& path, const std::string& source);

  Json json_ = Json::object();
  std::map<std::string, std::string> by_path_;
};

}  // namespace lodestone::common
