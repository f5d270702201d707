#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodestone/geometry/zone.h"

namespace lodestone::safety {

/// Zones that another program tells, one that sees what moves in the dish: a file {"keep_out": [ZONE, ...]},
/// which that program replaces (rename(2)) whenever they move.
class ZonesFile {
 public:
  /// No path: there is no such file, and there are no zones.
  explicit ZonesFile(std::string path) : path_(std::move(path)) {}

  /// Those that it holds now. Throws ConfigError, naming the file, where it is missing or holds anything
  /// else.
  const std::vector<geometry::Zone>& zones();

 private:
  std::string path_;
  std::optional<std::string> text_;  // that the zones were read from
  std::vector<geometry::Zone> zones_;
};

}  // namespace lodestone::safety
