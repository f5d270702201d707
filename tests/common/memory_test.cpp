#include "lodestone/common/memory.h"

#include <catch2/catch.hpp>
#include <vector>

TEST_CASE("the peak of memory rises with what is held, in MB, and does not fall again") {
  const double before_mb = lodestone::common::peak_memory_mb();
  CHECK(before_mb > 1.0);
  {
    const std::vector<char> held(static_cast<std::size_t>(2.0 * before_mb * 1e6), 1);
    CHECK(held.back() == 1);
    CHECK(lodestone::common::peak_memory_mb() > 2.0 * before_mb);
  }
  CHECK(lodestone::common::peak_memory_mb() > 2.0 * before_mb);
}
