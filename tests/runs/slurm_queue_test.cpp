#include "lodestone/runs/slurm_queue.h"

#include <catch2/catch.hpp>

using namespace lodestone;

TEST_CASE("a queue is read as squeue prints it") {
  const auto tasks =
      runs::parse_queue("12|3|RUNNING|2\n12|4|COMPLETING|2\n14|N/A|PENDING|last\nslurm: noise\n");
  REQUIRE(tasks.size() == 3);
  CHECK(tasks[0].name() == "12_3");
  CHECK(tasks[0].comment == "2");
  CHECK_FALSE(tasks[0].ending);
  CHECK(tasks[1].ending);
  CHECK(tasks[2].waiting);
  CHECK(tasks[2].name() == "14");
  CHECK(tasks[2].comment == "last");
  CHECK(runs::parse_queue("").empty());
}
