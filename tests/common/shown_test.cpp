#include "lodestone/common/shown.h"

#include <catch2/catch.hpp>

using lodestone::common::escaped;
using lodestone::common::shown;

TEST_CASE("what a terminal would act on is escaped, and what it would print stays") {
  CHECK(escaped("plain, 5 µm – ✓") == "plain, 5 µm – ✓");
  CHECK(escaped("two\nlines\tand\rmore") == "two\\nlines\\tand\\rmore");
  CHECK(escaped("\x1b[31mred\x7f") == "\\x1b[31mred\\x7f");
  CHECK(escaped(std::string_view("nul\0", 4)) == "nul\\x00");
  CHECK(escaped("\xc2\x9b"
                "31m") == "\\xc2\\x9b31m");  // a one-character escape sequence
}

TEST_CASE("bytes that are no UTF-8 are escaped one by one") {
  CHECK(escaped("\xff\xfe") == "\\xff\\xfe");
  CHECK(escaped("cut \xe2\x82") == "cut \\xe2\\x82");
  CHECK(escaped("\xc0\xaf") == "\\xc0\\xaf");
}

TEST_CASE("a long value is cut after 200 characters, never in the middle of one") {
  CHECK(shown(std::string(200, 'a')) == std::string(200, 'a'));
  CHECK(shown(std::string(201, 'a')) == std::string(200, 'a') + "...");
  std::string wide;
  for (int i = 0; i < 300; ++i) wide += "µ";
  CHECK(shown(wide) == wide.substr(0, 400) + "...");
}
