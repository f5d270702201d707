#pragma once

#include <catch2/catch.hpp>

#include "lodestone/data/dataset.h"

namespace lodestone::tests {

inline void check_equal(const data::Episode& a, const data::Episode& b) {
  CHECK(a.observations == b.observations);
  CHECK(a.actions == b.actions);
  CHECK(a.terminations == b.terminations);
  CHECK(a.truncations == b.truncations);
  CHECK(a.zero_current == b.zero_current);
  CHECK(a.placements == b.placements);
}

}  // namespace lodestone::tests
