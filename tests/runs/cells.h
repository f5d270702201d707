#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lodestone/runs/plan.h"

namespace lodestone::tests {

/// A cell of the verb collect.
inline runs::Cell cell(const std::string& id, std::vector<std::string> settings = {}) {
  runs::Cell made;
  made.id = id;
  made.verb = "collect";
  made.settings = std::move(settings);
  return made;
}

inline runs::Plan plan(std::vector<runs::Cell> cells) {
  runs::Plan made;
  made.cells = std::move(cells);
  return made;
}

}  // namespace lodestone::tests
