#include <catch2/catch.hpp>

#include "../../src/report/sections.h"
#include "report/small_run.h"

TEST_CASE("each filmed trial has its last image in the page, with its name in words") {
  lodestone::report::RunData run;
  run.filmed = {{"unseen-policy-square-0", "foobar"}};
  const std::string html = lodestone::report::camera_section(run);
  CHECK(lodestone::tests::holds(html, "data:image/jpeg;base64,Zm9vYmFy"));
  CHECK(lodestone::tests::holds(html, "alt=\"The last camera image of unseen-policy-square-0"));
}
