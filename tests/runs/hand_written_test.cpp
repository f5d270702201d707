#include "hand_written.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;
using common::Json;

TEST_CASE("what a person writes is told apart by kind, and a key that there is not by name") {
  const Json known = {{"text", ""},  {"whole", 1},           {"number", 0.5},      {"truth", false},
                      {"list", {1}}, {"object", {{"a", 1}}}, {"anything", nullptr}};
  const auto refusal = [&](const char* text) -> std::string {
    try {
      runs::check_hand_written(Json::parse(text), known, "plan.json", "part.");
    } catch (const common::ConfigError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(
      refusal(R"({"text": "a", "whole": 2, "number": 1, "truth": true, "list": [], "object": {}})").empty());
  CHECK(refusal(R"({"number": 0.25, "anything": [1], "text": null})").empty());
  CHECK(refusal("{}").empty());
  CHECK(refusal(R"({"txet": 1})") == "plan.json: unknown key part.txet = 1");
  CHECK(refusal(R"({"text": 1})") == "plan.json: part.text = 1 must be text in quotes");
  CHECK(refusal(R"({"whole": 1.5})") == "plan.json: part.whole = 1.5 must be a whole number");
  CHECK(refusal(R"({"number": "1"})") == "plan.json: part.number = \"1\" must be a number");
  CHECK(refusal(R"({"truth": "yes"})") == "plan.json: part.truth = \"yes\" must be true or false");
  CHECK(refusal(R"({"list": "a"})") == "plan.json: part.list = \"a\" must be a list [...]");
  CHECK(refusal(R"({"object": [1]})") == "plan.json: part.object = [1] must be an object {...}");
}
