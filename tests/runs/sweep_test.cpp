#include "lodestone/runs/sweep.h"

#include <catch2/catch.hpp>
#include <set>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "runs/cells.h"
#include "temporary_folder.h"

using namespace lodestone;
using runs::Sweep;
using runs::SweepPoint;

namespace {

Sweep read(const std::string& text) {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "sweep.json", text);
  return runs::read_sweep(folder / "sweep.json");
}

}  // namespace

TEST_CASE("a sweep has defaults, and says what is wrong with it") {
  const Sweep sweep = read(
      R"({"verb": "train-policy", "config": "best/x.json", "grid": {"a.b": [1, 2]}, "score": "result.x"})");
  CHECK(sweep.seeds == 1);
  CHECK_FALSE(read(R"({"verb": "deploy", "score": "summary.x", "random": null, "grid": null})").random);
  CHECK(sweep.config == std::vector<std::string>{"best/x.json"});
  const auto refused = [](const std::string& body, const std::string& what) {
    CAPTURE(body);
    CHECK_THROWS_WITH(read("{\"verb\": \"deploy\", \"score\": \"summary.x\", " + body + "}"),
                      Catch::Contains(what));
  };
  CHECK_THROWS_WITH(read(R"({"score": "result.x"})"), Catch::Contains("verb is missing"));
  CHECK_THROWS_WITH(read(R"({"verb": "deploy", "score": "result"})"), Catch::Contains("result.success_rate"));
  CHECK_THROWS_WITH(read("[]"), Catch::Contains("an object"));
  refused(R"("gird": {})", "unknown key gird");
  refused(R"("grid": {"td3.learning_rate": 0.001})", "grid.td3.learning_rate = 0.001 must be a list");
  refused(R"("grid": [1])", "grid = [1] must be an object");
  refused(R"("settings": {"a": 1})", "must be a list");
  refused(R"("settings": [1])", "settings must hold texts, not 1");
  refused(R"("lower_is_better": "yes")", "lower_is_better = \"yes\" must be true or false");
  refused(R"("seeds": "5")", "must be a whole number");
  refused(R"("random": {"count": 2, "ranges": {"a": [0, 1]}})", "random.ranges.a");
  refused(R"("seeds": 0)", "seeds = 0");
  refused(R"("grid": {"a": []})", "grid.a holds no value");
  refused(R"("grid": {"a": [1, 1]})", "twice");
  for (const char* seed : {R"("grid": {"seed": [1, 2]})", R"("settings": ["seed=3"])",
                           R"("random": {"count": 3, "ranges": {"seed": {"from": 1, "to": 2}}})",
                           R"("halving": {"key": "seed", "first": 1})"})
    refused(seed, "seeds and first_seed say which");
  refused(R"("random": {"count": 3})", "random.ranges is missing");
  refused(R"("random": {"count": 0, "ranges": {"a": {"from": 1, "to": 2}}})", "random.count = 0");
  refused(R"("random": {"count": 3, "ranges": {"a": {"from": 2, "to": 1}}})", "from must be below to");
  refused(R"("random": {"count": 3, "ranges": {"a": {"from": 0, "to": 1, "log": true}}})", "logarithmic");
  refused(R"("random": {"count": 3, "ranges": {"a": {"form": 1, "to": 2}}})", "random.ranges.a.form");
  refused(R"("grid": {"a": [1]}, "random": {"count": 3, "ranges": {"a": {"from": 1, "to": 2}}})",
          "both in grid");
  refused(R"("halving": {"key": "n", "first": 0})", "halving.first = 0");
  refused(R"("halving": {"key": "n", "first": 5, "factor": 1})", "halving.factor = 1");
  refused(R"("halving": {"key": "n", "first": 2, "factor": 100000, "rungs": 20})", "beyond 2^53");
  refused(R"("random": {"count": 3, "ranges": {"a": {"from": 1, "to": 1e30, "whole": true}}})",
          "within 2^53");
  CHECK(read(R"({"verb": "deploy", "score": "a.x", "halving": {"key": "n", "first": 5, "rungs": 3}})")
            .halving->budget(3) == 45);
}

TEST_CASE("a grid is every combination, named by the last part of its keys") {
  const Sweep sweep = read(
      R"({"verb": "deploy", "score": "summary.x", "grid": {"td3.rate": [0.1, 0.2], "on": ["a/b", "c"]}, "seeds": 2, "first_seed": 5})");
  const std::vector<SweepPoint> points = runs::points_of(sweep);
  REQUIRE(points.size() == 4);
  CHECK(points[0].name == "on=a_b,rate=0.1");
  CHECK(points[0].settings == std::vector<std::string>{"on=a/b", "td3.rate=0.1"});
  const std::vector<runs::Cell> cells = runs::sweep_cells(sweep, points, 1, "/x/preset.json");
  REQUIRE(cells.size() == 8);
  CHECK(cells[0].id == "on=a_b,rate=0.1/5");
  CHECK(*cells[0].seed == 5);
  CHECK(*cells[4].seed == 6);  // every point with one seed first
  CHECK(cells[0].config == "/x/preset.json");
  CHECK(runs::points_of(read(R"({"verb": "deploy", "score": "summary.x"})")).at(0).name == "as_it_is");
  const auto twins =
      runs::points_of(read(R"({"verb": "deploy", "score": "s.x", "grid": {"a.rate": [1], "b.rate": [2]}})"));
  CHECK(twins.at(0).name == "a.rate=1,b.rate=2");
  const auto above = runs::points_of(
      read(R"({"verb": "deploy", "score": "s.x", "grid": {"data": ["../a.h5", "..."]}, "seeds": 1})"));
  CHECK(above.at(0).name == "data=_._a.h5");
  for (const runs::SweepPoint& point : above) CHECK(point.name.find("..") == std::string::npos);
}

TEST_CASE("random search draws within its ranges, the same every time, each with a name of its own") {
  const Sweep sweep = read(R"({"verb": "deploy", "score": "s.x", "grid": {"k": [1, 2]},
      "random": {"count": 50, "ranges": {"a": {"from": 0.001, "to": 0.1, "log": true}, "n": {"from": 1, "to": 4, "whole": true}}}})");
  const std::vector<SweepPoint> points = runs::points_of(sweep);
  REQUIRE(points.size() == 100);
  std::set<std::string> names, whole;
  int below = 0;
  for (const SweepPoint& point : points) {
    names.insert(point.name);
    REQUIRE(point.settings.size() == 3);
    const double a = std::stod(point.settings[1].substr(2));
    CHECK(a >= 0.001);
    CHECK(a <= 0.1);
    below += a < 0.01 ? 1 : 0;
    whole.insert(point.settings[2].substr(2));
  }
  CHECK(names.size() == 100);
  CHECK(below > 30);  // half of them, as the scale is logarithmic
  CHECK(below < 70);
  for (const std::string& n : whole) CHECK(std::set<std::string>{"1", "2", "3", "4"}.count(n) == 1);
  CHECK(runs::points_of(sweep)[7].settings == points[7].settings);
}

TEST_CASE("scores are read from the runs, and the best go on to the next rung") {
  const tests::TemporaryFolder folder;
  Sweep sweep = read(R"({"verb": "collect", "score": "result.deep.x", "grid": {"k": [1, 2, 3]}, "seeds": 2,
      "halving": {"key": "n", "first": 10, "factor": 3, "rungs": 2}})");
  const std::vector<SweepPoint> points = runs::points_of(sweep);
  const runs::PlanPlace place{folder.path(), "lodestone", "configs"};
  runs::Plan plan;
  plan.cells = runs::sweep_cells(sweep, points, 1, "");
  CHECK(plan.cells[0].settings.back() == "n=10");
  CHECK(runs::sweep_cells(sweep, points, 2, "")[0].settings.back() == "n=30");
  CHECK(runs::sweep_cells(sweep, points, 2, "")[0].id == "rung2/k=1/1");
  const double scores[] = {1.0, 5.0, 3.0, 2.0, 7.0};  // the last run is not finished
  for (std::size_t i = 0; i < 5; ++i) {
    tests::finish(plan, place, plan.cells[i].id);
    common::write_file_atomically(folder / plan.cells[i].id + "/result.json",
                                  "{\"deep\": {\"x\": " + std::to_string(scores[i]) + "}}");
  }
  const auto rows = runs::rung_results(sweep, points, 1, plan, place);
  REQUIRE(rows.size() == 3);
  CHECK(rows[0].point.name == "k=2");
  CHECK(*rows[0].mean == Approx(6.0));
  CHECK((*rows[0].interval)[0] == Approx(5.0));
  CHECK(rows[1].point.name == "k=3");
  CHECK_FALSE(rows[1].interval);
  CHECK_FALSE(rows[1].scores[1]);
  CHECK_FALSE(rows[0].from_best);
  CHECK(*rows[1].from_best == Approx(-2.0));  // of the seed that both have
  CHECK_FALSE(rows[1].from_best_interval);
  CHECK(*rows[2].from_best == Approx(-4.5));
  CHECK((*rows[2].from_best_interval)[0] == Approx(-5.0));
  CHECK((*rows[2].from_best_interval)[1] == Approx(-4.0));
  REQUIRE(runs::promoted(sweep, rows).size() == 1);
  CHECK(runs::promoted(sweep, rows)[0].name == "k=2");
  sweep.lower_is_better = true;
  CHECK(runs::rung_results(sweep, points, 1, plan, place)[0].point.name == "k=1");

  sweep.score = "result.deep.y";
  CHECK_THROWS_WITH(runs::sweep_score(sweep, folder / plan.cells[0].id), Catch::Contains("it has deep.x"));
  sweep.score = "nothing.x";
  CHECK_THROWS_WITH(runs::sweep_score(sweep, folder / plan.cells[0].id),
                    Catch::Contains("it leaves") && Catch::Contains("result"));
}
