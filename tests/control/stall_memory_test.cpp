#include "lodestone/control/stall_memory.h"

#include <catch2/catch.hpp>

using namespace lodestone;
using geometry::Pose2;

TEST_CASE("a pulse like one that moved nothing here is known until the needle lies elsewhere", "[unit]") {
  const Pose2 here = {0.01, 0.0, 0.2};
  const Pose2 beside = {0.0101, 0.0, 0.21};
  const Pose2 there = {0.01, 0.005, 0.2};
  const Pose2 turned = {0.01, 0.0, 0.4};
  control::StallMemory memory(0.5e-3, 0.05);
  CHECK_FALSE(memory.repeats({here, {2.0, 0.0}, here}));
  CHECK(memory.repeats({here, {2.0, 0.0}, beside}));
  CHECK(memory.repeats({beside, {2.2, 0.2}, here}));
  CHECK(memory.stalls(beside, {2.2, 0.2}));
  CHECK_FALSE(memory.stalls(there, {2.2, 0.2}));
  CHECK_FALSE(memory.stalls(here, {4.0, 0.0}));
  CHECK_FALSE(memory.repeats({here, {4.0, 0.0}, here}));
  CHECK_FALSE(memory.repeats({here, {0.0, 2.0}, here}));
  CHECK_FALSE(memory.repeats({here, {0.0, 0.0}, here}));
  CHECK_FALSE(memory.repeats({here, {2.0, 0.0}, there}));     // it moved after all
  CHECK_FALSE(memory.repeats({turned, {4.0, 0.0}, turned}));  // it lies otherwise
  CHECK_FALSE(memory.repeats({here, {4.0, 0.0}, here}));
  memory.reset();
  CHECK_FALSE(memory.repeats({here, {4.0, 0.0}, here}));
}
