#include "lodestone/common/config.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "lodestone/common/error.h"
#include "temporary_folder.h"

namespace {

using namespace lodestone::common;

struct SceneConfig {
  Range blur_px{0.5, 1.5};
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("blur_px", blur_px, "px", "blur", {0.0, 10.0});
  }
};

enum class Shape { kRound, kSquare };
std::vector<std::string> names_of(Shape) { return {"round", "square"}; }

struct DishConfig {
  double radius_m = 0.0425;
  double rim_m = 0.001;
  Shape shape = Shape::kRound;
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("radius_m", radius_m, "m", "inner radius", {0.005, 0.5});
    v.field("rim_m", rim_m, "m", "width of the rim", {0.0, 0.5});
    v.field("shape", shape, "", "its outline");
  }
  void validate() const {
    if (rim_m >= radius_m) throw InvalidConfig("rim_m", rim_m, "be below radius_m");
  }
};

struct ExampleConfig {
  std::int64_t steps = 10;
  bool fast = false;
  std::string optimiser = "adam";
  std::vector<std::int64_t> hidden = {256, 128};
  DishConfig dish;
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("steps", steps, "", "number of steps", {1, 1000});
    v.field("fast", fast, "", "whether to hurry");
    v.field("optimiser", optimiser, "", "which optimiser", {"adam", "sgd"});
    v.field("hidden", hidden, "", "layer widths", {1, 4096});
    v.group("dish", dish, "the dish");
  }
  void validate() const {
    if (fast && steps > 100) throw InvalidConfig("steps", steps, "be at most 100 with fast = true");
  }
};

struct CoilConfig {
  std::string name;
  std::int64_t turns = 100;
  std::vector<std::string> tags;
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("name", name, "", "what it is called");
    v.field("turns", turns, "", "of wire", {1, 1000});
    v.field("tags", tags, "", "words");
  }
  void validate() const {
    if (name.empty()) throw InvalidConfig("name", name, "be given");
  }
};

struct BenchConfig {
  std::int64_t turns = 200;
  std::vector<CoilConfig> coils;
  template <class Visitor>
  void visit(Visitor& v) {
    v.field("turns", turns, "", "of a coil that does not say", {1, 1000});
    CoilConfig plain;
    plain.turns = turns;
    v.list("coils", coils, plain, "the coils");
  }
};

std::string message_of(const char* text) {
  try {
    config_from_json<ExampleConfig>(Json::parse(text), "a.json");
  } catch (const ConfigError& error) {
    CHECK(error.exit_code() == 2);
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("a configuration reads over its defaults and writes back what it read") {
  const auto config =
      config_from_json<ExampleConfig>(Json::parse(R"({"steps": 20, "dish": {"radius_m": 0.05}})"), "a.json");
  CHECK(config.steps == 20);
  CHECK(config.dish.radius_m == 0.05);
  CHECK(config.optimiser == "adam");
  const Json json = config_to_json(config);
  CHECK(json["dish"]["radius_m"] == 0.05);
  CHECK(config_to_json(config_from_json<ExampleConfig>(json, "again")) == json);
}

TEST_CASE("a bad key or value is one line naming source, key, value and bound") {
  CHECK(message_of(R"({"stesp": 3})") == "a.json: unknown key stesp = 3; did you mean steps?");
  CHECK(message_of(R"({"dish": {"radius_mm": 3}})") ==
        "a.json: unknown key dish.radius_mm = 3; did you mean dish.radius_m?");
  CHECK(message_of(R"({"dish": {"radius_m": 3}})") ==
        "a.json: dish.radius_m = 3 must be within 0.005 .. 0.5");
  CHECK(message_of(R"({"dish": {"radius_m": "wide"}})") ==
        "a.json: dish.radius_m = \"wide\" must be a number in m");
  CHECK(message_of(R"({"dish": 4})") == "a.json: dish = 4 must be a JSON object {...}");
  CHECK(message_of(R"({"steps": 2.5})") == "a.json: steps = 2.5 must be a whole number");
  CHECK(message_of(R"({"fast": 1})") == "a.json: fast = 1 must be true or false");
  CHECK(message_of(R"({"optimiser": "lion"})") == "a.json: optimiser = \"lion\" must be one of adam, sgd");
  CHECK(message_of(R"({"hidden": [8, 0]})") == "a.json: hidden = [8,0] must be within 1 .. 4096");
  CHECK(message_of(R"({"dish": {"shape": "oval"}})") ==
        "a.json: dish.shape = \"oval\" must be one of round, square");
  CHECK(message_of(R"({"fast": true, "steps": 200})") ==
        "a.json: steps = 200 must be at most 100 with fast = true");
  CHECK(message_of(R"({"zzzzzzzzzzzz": 1})").find("known keys are dish, fast") != std::string::npos);
}

TEST_CASE("overrides reach nested keys and are read as JSON, else as text") {
  Json json = Json::object();
  apply_override(json, "dish.radius_m=0.06");
  apply_override(json, "optimiser=sgd");
  apply_override(json, "hidden=[4, 4]");
  const auto config = config_from_json<ExampleConfig>(json, "command line");
  CHECK(config.dish.radius_m == 0.06);
  CHECK(config.optimiser == "sgd");
  CHECK(config.hidden == std::vector<std::int64_t>{4, 4});
  CHECK_THROWS_AS(apply_override(json, "optimiser"), ConfigError);
  CHECK_THROWS_AS(apply_override(json, "optimiser.name=3"), ConfigError);
}

TEST_CASE("a missing or malformed file is reported with its place") {
  const lodestone::tests::TemporaryFolder folder;
  CHECK_THROWS_WITH(read_json_file(folder / "none.json"), Catch::Contains("none.json does not exist"));
  std::ofstream(folder / "bad.json") << "{\n  \"a\": 1,\n  \"b\": oops\n}";
  CHECK_THROWS_WITH(read_json_file(folder / "bad.json"), Catch::Contains("bad.json:3:"));
  std::ofstream(folder / "good.json") << "{ // a comment\n \"a\": 1}";
  CHECK(read_json_file(folder / "good.json")["a"] == 1);
}

TEST_CASE("every key is described with default, unit and bounds") {
  const auto rows = describe_config<ExampleConfig>();
  REQUIRE(rows.size() == 7);
  CHECK(rows[2].bounds == "adam | sgd");
  CHECK(rows[4].key == "dish.radius_m");
  CHECK(rows[4].value == 0.0425);
  CHECK(rows[4].unit == "m");
  CHECK(rows[4].bounds == "0.005 .. 0.5");
  CHECK(rows[6].value == "round");
  CHECK(rows[6].bounds == "round | square");
}

TEST_CASE("a nested configuration whose values do not fit together is refused by its file and path") {
  const ConfigSources sources("command line",
                              {{"dish.radius_m", "rig.json"}, {"dish.rim_m", "--set dish.rim_m"}});
  const auto read = [&](const char* text) {
    return config_from_json<ExampleConfig>(Json::parse(text), sources).dish.shape;
  };
  CHECK_THROWS_WITH(read(R"({"dish": {"radius_m": 0.01, "rim_m": 0.2}})"),
                    "--set dish.rim_m: dish.rim_m = 0.2 must be below radius_m");
  CHECK(read(R"({"dish": {"shape": "square"}})") == Shape::kSquare);
  ExampleConfig config;
  config.dish.rim_m = 1.0;  // by whoever calls
  CHECK_THROWS_AS(config_from_json<ExampleConfig>(Json::object(), "a.json", config), ConfigError);
}

TEST_CASE("a range is two numbers in order, within the key's bounds") {
  const auto read = [](const char* text) {
    return config_from_json<SceneConfig>(Json::parse(text), "here").blur_px;
  };
  CHECK(read("{}").low == 0.5);
  CHECK(read(R"({"blur_px": [1, 2]})").high == 2.0);
  CHECK(config_to_json(SceneConfig{})["blur_px"] == Json({0.5, 1.5}));
  for (const char* bad : {R"({"blur_px": 1})", R"({"blur_px": [2, 1]})", R"({"blur_px": [1]})",
                          R"({"blur_px": [1, 11]})", R"({"blur_px": [1, "2"]})"})
    CHECK_THROWS_WITH(read(bad), Catch::Contains("blur_px"));
  CHECK(describe_config<SceneConfig>().front().value == Json({0.5, 1.5}));
}

TEST_CASE("a file that is too deep, too large, no file or names a key twice is refused with its name") {
  const lodestone::tests::TemporaryFolder folder;
  const auto fault_of = [&](const std::string& text) {
    std::ofstream(folder / "a.json") << text;
    try {
      read_json_file(folder / "a.json");
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(fault_of(std::string(100'000, '[')),
             Catch::Contains("a.json:1:65: nested deeper than 64 levels"));
  CHECK_THAT(fault_of("{\"a\": 1e999}"),
             Catch::Contains("a.json:1:") && Catch::Contains("1e999 is too large"));
  CHECK_THAT(fault_of("{\"a\": 1,\n\"a\": 2}"), Catch::Contains("a.json:2:3: the key \"a\" is given twice"));
  CHECK_THAT(fault_of(std::string(5'000'000, ' ')), Catch::Contains("at most 4194304 are read"));
  CHECK_THROWS_AS(read_json_file("/dev/zero"), ConfigError);
  CHECK_THROWS_AS(read_json_file(folder.path()), ConfigError);
}

TEST_CASE("an override that is too deep, or no text, is one line") {
  Json json = Json::object();
  std::string path = "a";
  for (int i = 0; i < 1000; ++i) path += ".a";
  CHECK_THROWS_WITH(apply_override(json, path + "=1"), Catch::Contains("more than 32 steps"));
  apply_override(json, "steps=\xff\n");
  CHECK_THROWS_WITH(config_from_json<ExampleConfig>(json, "--set"),
                    Catch::Contains("must be a whole number"));
  CHECK(message_of("{\"steps\": 18446744073709551615}").find("at most 9223372036854775807") !=
        std::string::npos);
  const std::string long_key(5000, 'k');
  CHECK(message_of(("{\"" + long_key + "\": 1}").c_str()).size() < 400);
}

TEST_CASE("a list of configurations takes what an item does not say from a plain one") {
  const auto read = [](const char* text) {
    return config_from_json<BenchConfig>(Json::parse(text), "b.json");
  };
  CHECK(read("{}").coils.empty());
  const BenchConfig bench =
      read(R"({"turns": 300, "coils": [{"name": "a"}, {"name": "b", "turns": 5, "tags": ["x", "y"]}]})");
  REQUIRE(bench.coils.size() == 2);
  CHECK(bench.coils[0].turns == 300);
  CHECK(bench.coils[1].turns == 5);
  CHECK(bench.coils[1].tags == std::vector<std::string>{"x", "y"});
  const Json json = config_to_json(bench);
  CHECK(json["coils"][1] == Json({{"name", "b"}, {"turns", 5}, {"tags", {"x", "y"}}}));
  CHECK(config_to_json(config_from_json<BenchConfig>(json, "again")) == json);

  CHECK_THROWS_WITH(read(R"({"coils": [{"name": "a"}, {"name": "b", "turns": 0}]})"),
                    Catch::Equals("b.json: coils[1].turns = 0 must be within 1 .. 1000"));
  CHECK_THROWS_WITH(read(R"({"coils": [{"turns": 5}]})"),
                    Catch::Contains("coils[0].name = \"\" must be given"));
  CHECK_THROWS_WITH(read(R"({"coils": [{"name": "a", "turn": 5}]})"),
                    Catch::Contains("unknown key coils[0].turn"));
  CHECK_THROWS_WITH(read(R"({"coils": [{"name": "a", "tags": "x"}]})"),
                    Catch::Contains("must be a list of texts"));
  CHECK_THROWS_WITH(read(R"({"coils": {}})"), Catch::Contains("must be a list of objects"));
  const ConfigSources sources("command line", {{"coils", "coils.json"}});
  CHECK_THROWS_WITH(config_from_json<BenchConfig>(Json::parse(R"({"coils": [{"name": 3}]})"), sources),
                    Catch::StartsWith("coils.json: coils[0].name = 3"));
}
