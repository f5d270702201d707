#include "lodestone/common/json.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

namespace {

using namespace lodestone::common;

std::string fault_of(const std::string& text) {
  try {
    parse_json(text, "a.json");
  } catch (const DataError& error) {
    return error.what();
  }
  return "accepted";
}

std::string repeated(const std::string& text, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += text;
  return out;
}

}  // namespace

TEST_CASE("JSON reads as nlohmann-json reads it") {
  const std::string text =
      R"({"a": [1, -2, 0.5, true, null, "x"], "b": {"c": {}}, "d": [], "e": 18446744073709551615})";
  CHECK(parse_json(text, "a.json") == Json::parse(text));
  CHECK(parse_json(text, "a.json").dump() == Json::parse(text).dump());  // the order of the keys, too
  CHECK(parse_json(" 3 ", "a.json") == 3);
  CHECK(parse_json("{ // why\n\"a\": 1}", "a.json", JsonComments::kAllowed)["a"] == 1);
  CHECK(find_json("[1]") == Json::parse("[1]"));
  CHECK(find_json("null")->is_null());
  CHECK_FALSE(find_json("[1"));
}

TEST_CASE("a fault is named with its line and column") {
  CHECK(fault_of("{\n  \"a\": 1,\n  \"b\": oops\n}").find("a.json:3:8: not JSON: ") == 0);
  CHECK(fault_of("").find("a.json:1:1: not JSON: ") == 0);
  CHECK(fault_of("{} {}").find("a.json:1:4: not JSON: ") == 0);
  CHECK(fault_of("{ // comment\n}").find("a.json:1:") == 0);
  CHECK(fault_of("[\"\xff\"]").find("not JSON") != std::string::npos);
}

TEST_CASE("a key that is given twice is refused, wherever it is") {
  CHECK(fault_of("{\"a\": 1, \"a\": 2}") == "a.json:1:12: the key \"a\" is given twice");
  CHECK(fault_of("[{}, {\"b\": {\"a\": 1, \"b\": 2, \"a\": 1}}]").find("\"a\" is given twice") !=
        std::string::npos);
  CHECK(fault_of("{\"a\": {\"a\": 1}, \"b\": {\"a\": 1}}") == "accepted");
}

TEST_CASE("a number that no double can hold is refused") {
  CHECK(fault_of("[1e999]").find("a.json:1:7: the number 1e999 is too large") == 0);
  CHECK(fault_of("[-1e999]") != "accepted");
  CHECK(fault_of("[1e-999, 1e308]") == "accepted");
}

TEST_CASE("depth and keys have a limit") {
  CHECK(fault_of(repeated("[", 64) + repeated("]", 64)) == "accepted");
  CHECK(fault_of(repeated("[", 65) + repeated("]", 65)).find("nested deeper than 64 levels") !=
        std::string::npos);
  CHECK(fault_of(repeated("{\"a\":", 100'000)).find("nested deeper than 64 levels") != std::string::npos);
  std::string keys = "{";
  for (int i = 0; i < 10'001; ++i) keys += (i > 0 ? ",\"" : "\"") + std::to_string(i) + "\":0";
  CHECK(fault_of(keys + "}").find("more than 10000 keys") != std::string::npos);
}

TEST_CASE("a text of too many values is refused", "[slow]") {
  CHECK(fault_of("[" + std::string(1, '0') + repeated(",0", 20'000'000) + "]")
            .find("more than 20000000 values") != std::string::npos);
}

TEST_CASE("a value is shown on one line, cut, whatever bytes it holds") {
  CHECK(shown_json({{"a", "x\ny"}}) == R"({"a":"x\ny"})");
  CHECK(shown_json(std::string(300, 'a')).size() == 203);
  CHECK(shown_json("\x7f") == "\"\\x7f\"");
  CHECK_NOTHROW(shown_json("\xff"));
}
