#include "lodestone/console/console_bench.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "temporary_folder.h"

using namespace lodestone;
using console::ConsoleBench;
using console::ConsoleBenchConfig;

TEST_CASE("a console that does not start is told, with what it said") {
  const tests::TemporaryFolder folder;
  const ConsoleBenchConfig config;
  ConsoleBench bench(config, folder.path(), "/bin/echo");
  CHECK_THROWS_WITH(bench.time_first_image(),
                    Catch::Contains("did not start") && Catch::Contains("--virtual"));
}

TEST_CASE("one page is timed before an emulated bench", "[slow]") {
  const tests::TemporaryFolder folder;
  ConsoleBenchConfig config;
  config.deployment.sensor.segmenter = LODESTONE_SOURCE_DIR "/models/segmenter";
  config.look_s = 2.0;
  config.clicks = 2;
  ConsoleBench bench(config, folder.path(), "");
  bench.time_one_page();
  const console::ConsoleBenchResult& result = bench.result();
  CHECK(*result.images_per_s > 5.0);
  CHECK(*result.image_median_ms > 0.0);
  CHECK(*result.server_share > 0.0);
  REQUIRE(result.click_ms.size() == 2);
  CHECK(result.click_ms[0] > 0.0);
  CHECK(result.figures.size() == 3);
}
