#include "lodestone/common/artefact.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

namespace {

using namespace lodestone::common;

struct Part {
  double mean_mm = 0.0;
  std::optional<std::int64_t> steps;
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("mean_mm", mean_mm);
    v.field("steps", steps);
  }
};

struct Whole {
  std::string name;
  bool good = false;
  std::optional<Part> truth;
  std::optional<Part> sensed;
  std::vector<std::optional<std::array<double, 2>>> track;
  std::map<std::string, Part> by_task;
  std::map<int, double> by_step;
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("name", name);
    v.field("good", good);
    v.part("mean_mm", truth);
    v.field("sensed", sensed);
    v.field("track", track);
    for (const char* task : {"centre", "square"}) v.entry(task, by_task);
    v.field("by_step", by_step);
  }
};

Whole example() {
  Whole whole;
  whole.name = "one";
  whole.good = true;
  whole.truth = Part{1.5, 7};
  whole.track = {std::array<double, 2>{0.1, -2.0}, std::nullopt};
  whole.by_task["square"] = {3.0, std::nullopt};
  whole.by_step[5] = 0.25;
  return whole;
}

}  // namespace

TEST_CASE("an artefact reads back as it was written, and what was not measured is absent") {
  const lodestone::tests::TemporaryFolder folder;
  write_artefact(folder / "whole.json", example());
  const Json json = Json::parse(read_file(folder / "whole.json"));
  CHECK(json["mean_mm"] == 1.5);
  CHECK_FALSE(json.contains("sensed"));
  CHECK_FALSE(json.contains("centre"));
  CHECK_FALSE(json["square"].contains("steps"));
  const auto read = read_artefact<Whole>(folder / "whole.json");
  CHECK(artefact_to_json(read) == json);
  CHECK(read.truth->steps == 7);
  CHECK_FALSE(read.sensed);
  REQUIRE(read.track.size() == 2);
  CHECK(read.track[0]->at(1) == -2.0);
  CHECK_FALSE(read.track[1]);
  CHECK(read.by_step.at(5) == 0.25);
  CHECK(read.by_task.count("centre") == 0);
  CHECK_FALSE(find_artefact<Whole>(folder / "nowhere.json"));
}

TEST_CASE("what cannot be read is named, with its file") {
  Json json = artefact_to_json(example());
  json["square"]["mean_mm"] = "wide";
  CHECK_THROWS_WITH(artefact_from_json<Whole>(json, "a.json"), Catch::Contains("a.json: square.mean_mm"));
  json = artefact_to_json(example());
  json.erase("name");
  CHECK_THROWS_WITH(artefact_from_json<Whole>(json, "a.json"), Catch::Contains("name is missing"));
  json = artefact_to_json(example());
  json["track"][0] = 4;
  CHECK_THROWS_WITH(artefact_from_json<Whole>(json, "a.json"), Catch::Contains("track"));
  json = artefact_to_json(example());
  json["by_step"]["5th"] = 1.0;
  CHECK_THROWS_WITH(artefact_from_json<Whole>(json, "a.json"), Catch::Contains("by_step.5th"));
  CHECK_THROWS_AS(artefact_from_json<Whole>(Json(3), "a.json"), DataError);
  CHECK_THROWS_WITH(read_artefact<Whole>("/nowhere.json"), Catch::Contains("/nowhere.json"));
}

TEST_CASE("keys of other versions are no fault, and a number that was not finite stays none") {
  Json json = artefact_to_json(example());
  json["of a later version"] = 1;
  json["mean_mm"] = 2.0;
  CHECK(artefact_from_json<Whole>(json, "a.json").truth->mean_mm == 2.0);
  const auto part = artefact_from_json<Part>(Json::parse(artefact_to_json(Part{NAN, {}}).dump()), "a.json");
  CHECK(std::isnan(part.mean_mm));
}

TEST_CASE("a whole number is one, and fits") {
  for (const char* bad : {"1.5", "1e300", "18446744073709551615", "true", "\"7\""}) {
    const Json json = {{"mean_mm", 1.0}, {"steps", Json::parse(bad)}};
    CHECK_THROWS_WITH(artefact_from_json<Part>(json, "a.json"), Catch::Contains("a.json: steps"));
  }
  CHECK(artefact_from_json<Part>({{"mean_mm", 1.0}, {"steps", 3.0}}, "a.json").steps == 3);
}
