#include "lodestone/safety/zones_file.h"

#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"

namespace lodestone::safety {
namespace {

constexpr const char* kList = "keep_out";

struct Content {
  std::vector<geometry::Zone> keep_out;

  template <class Visitor>
  void visit(Visitor& v) {
    v.list(kList, keep_out, geometry::Zone{}, "zones that the needle must keep out of");
  }
};

std::vector<geometry::Zone> zones_in(const std::string& text, const std::string& path) {
  const common::Json json = common::parse_json(text, path);
  if (!json.is_object() || !json.contains(kList))
    throw common::ConfigError(path + ": holds no list \"keep_out\" of zones (safety.keep_out_file)");
  return common::config_from_json<Content>(json, path).keep_out;
}

}  // namespace

const std::vector<geometry::Zone>& ZonesFile::zones() {
  if (path_.empty()) return zones_;
  try {
    std::string text = common::read_file(path_, common::kLargestConfig);
    if (text_ != text) {
      zones_ = zones_in(text, path_);
      text_ = std::move(text);
    }
  } catch (const common::ConfigError&) {
    throw;
  } catch (const common::Error& error) {
    throw common::ConfigError(std::string(error.what()) + " (safety.keep_out_file)");
  }
  return zones_;
}

}  // namespace lodestone::safety
