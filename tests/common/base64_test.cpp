#include "lodestone/common/base64.h"

#include <catch2/catch.hpp>

using namespace lodestone::common;

TEST_CASE("bytes become base64 text") {
  using lodestone::common::base64;
  CHECK(base64("").empty());
  CHECK(base64("f") == "Zg==");
  CHECK(base64("foobar") == "Zm9vYmFy");
  CHECK(base64(std::string("\0\xff\x10", 3)) == "AP8Q");
}
