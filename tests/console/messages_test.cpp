#include "lodestone/console/messages.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;
using namespace lodestone::console;

TEST_CASE("a page's messages are read") {
  CHECK(std::holds_alternative<WantsImage>(parse_message(R"({"do": "more", "of": "image"})")));
  CHECK(std::holds_alternative<WantsState>(parse_message(R"({"do": "more", "of": "state"})")));
  const auto beat = std::get<Beat>(parse_message(R"({"do": "beat", "visible": true, "focused": false})"));
  CHECK(beat.visible);
  CHECK_FALSE(beat.focused);
  CHECK(std::get<StopAsked>(parse_message(R"({"do": "stop", "by": "space"})")).by == "space");
  CHECK(std::get<StopAsked>(parse_message(R"({"do": "stop", "by": "the fire brigade"})")).by == "page");
  const auto go = std::get<Go>(parse_message(R"({"do": "go", "to": [0.5, 0.25], "towards": [0.6, 0.25]})"));
  CHECK(go.to == geometry::Vector2(0.5, 0.25));
  CHECK(go.towards.value().x() == 0.6);
  CHECK_FALSE(std::get<Go>(parse_message(R"({"do": "go", "to": [0, 1]})")).towards);
  const auto stroke = std::get<DrawnStroke>(parse_message(R"({"do": "draw", "points": [[0, 0], [1, 1]]})"));
  CHECK(stroke.points.size() == 2);
  CHECK_FALSE(stroke.closed);
  CHECK(std::get<DrawnShape>(parse_message(R"({"do": "draw", "shape": "square"})")).name == "square");
  CHECK(std::get<StartJob>(parse_message(R"({"do": "job", "verb": "collect"})")).verb == "collect");
  CHECK_FALSE(std::get<StartJob>(parse_message(R"({"do": "job", "verb": null})")).verb);
  CHECK(std::get<Hand>(parse_message(R"({"do": "hand", "drive": [-1, 0.5]})")).drive.y() == 0.5);
}

TEST_CASE("what is no message is refused") {
  for (const char* text : {
           "",
           "null",
           "7",
           "\"stop\"",
           "[]",
           "{}",
           "{",
           R"({"do": 7})",
           R"({"do": "launch"})",
           R"({"do": "stop"})",
           R"({"do": "stop", "by": 7})",
           R"({"do": "stop", "by": "space", "now": true})",
           R"({"do": "arm", "of": "x"})",
           R"({"do": "go", "to": [0.5]})",
           R"({"do": "go", "to": [0.5, "a"]})",
           R"({"do": "go", "to": [0.5, 7]})",
           R"({"do": "go", "to": [1e999, 0]})",
           R"({"do": "hand", "drive": [1.1, 0]})",
           R"({"do": "hand", "drive": [null, 0]})",
           R"({"do": "draw", "points": [[0, 0]]})",
           R"({"do": "draw", "points": [[0, 0], 3]})",
           R"({"do": "draw"})",
           R"({"do": "more", "of": "everything"})",
           R"({"do": "job", "verb": 3})",
           "{\"do\": \"stop\", \"by\": \"\xff\"}",
       })
    CHECK_THROWS_AS(parse_message(text), common::DataError);
  CHECK_THROWS_AS(parse_message(R"({"do": "replay", "name": ")" + std::string(300, 'a') + "\"}"),
                  common::DataError);
  CHECK_THROWS_AS(parse_message(std::string(kMostMessageBytes + 1, ' ')), common::DataError);
  CHECK_THROWS_AS(parse_message(std::string(60000, '[')), common::DataError);
  std::string points = R"({"do": "draw", "points": [)";
  for (std::size_t i = 0; i < kMostDrawnPoints; ++i) points += "[0,0],";
  CHECK_THROWS_AS(parse_message(points + "[0,0]]}"), common::DataError);
}

TEST_CASE("everybody may watch and stop; the rest needs the seat") {
  for (const char* text : {R"({"do": "stop", "by": "button"})", R"({"do": "operate"})", R"({"do": "runs"})",
                           R"({"do": "more", "of": "state"})", R"({"do": "replay", "name": "x"})"})
    CHECK_FALSE(needs_the_seat(parse_message(text)));
  for (const char* text :
       {R"({"do": "arm"})", R"({"do": "rearm", "reason": ""})", R"({"do": "go", "to": [0, 0]})",
        R"({"do": "hand", "drive": [0, 0]})", R"({"do": "draw", "shape": "circle"})",
        R"({"do": "job", "verb": null})", R"({"do": "record", "on": true})", R"({"do": "yield"})"})
    CHECK(needs_the_seat(parse_message(text)));
}
