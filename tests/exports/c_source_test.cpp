#include "c_source.h"

#include <catch2/catch.hpp>

using namespace lodestone::exports;

TEST_CASE("a number in C is a float, whatever it is", "[unit]") {
  CHECK(c_number(15.0) == "15.0f");
  CHECK(c_number(-0.25) == "-0.25f");
  CHECK(c_number(1e-12) == "1e-12f");
  for (const float number : {0.1F, 1.0F / 3.0F, 1.17549435e-38F, 16777215.0F})
    CHECK(std::stof(c_number(number)) == number);
}

TEST_CASE("a comment ends where it ends and has lines of limited length", "[unit]") {
  CHECK(c_comment("one\ntwo") == "/* one\n * two\n */\n");
  const std::string hostile =
      c_comment("*/ int main; /* */*/ //" + std::string(300, 'x') + " and so on " + std::string(90, 'y'));
  CHECK(hostile.find("*/") == hostile.size() - 3);
  CHECK(hostile.find("/*", 2) == std::string::npos);
  std::size_t begin = 0;
  for (std::size_t end = 0; (end = hostile.find('\n', begin)) != std::string::npos; begin = end + 1)
    CHECK(end - begin <= 103);
}

TEST_CASE("an array in C is wrapped", "[unit]") {
  CHECK(c_array("a", std::vector<std::int16_t>{1, -2, 12700}) ==
        "static const int16_t a[3] LODESTONE_PROGRAM = {\n  1,-2,12700,\n};\n");
  CHECK(c_array("b", std::vector<float>{0.5F}) ==
        "static const float b[1] LODESTONE_PROGRAM = {\n  0.5f,\n};\n");
}
