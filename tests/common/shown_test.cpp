#include "lodestone/common/shown.h"

#include <catch2/catch.hpp>

using lodestone::common::escaped;
using lodestone::common::is_utf8;
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

TEST_CASE("UTF-8 is what JSON takes for it") {
  for (const char* good :
       {"", "plain\n", "µ–✓", "\xf0\x9f\xa7\xb2", "\xc2\x80", "\xed\x9f\xbf", "\xf4\x8f\xbf\xbf"})
    CHECK(is_utf8(good));
  for (const char* bad : {"\xff", "\xc0\x80", "\xe0\x80\x80", "\xed\xa0\x80", "\xf0\x80\x80\x80",
                          "\xf4\x90\x80\x80", "\xe2\x82", "a\x80"})
    CHECK_FALSE(is_utf8(bad));
}
