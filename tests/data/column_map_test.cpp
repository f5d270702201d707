#include "lodestone/data/column_map.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;
using Catch::Matchers::Contains;
using data::Quantity;

namespace {

const std::string kQuotedMap = "time=Time [s],x=X_px,y=\"Y, of the image\",currents=I1|I2|I3|I4";

std::vector<data::MappedColumn> found(const std::string& map, const std::string& units,
                                      const std::vector<std::string>& header) {
  return data::find_columns(data::parse_map(map), units, header, "log.csv:1");
}

}  // namespace

TEST_CASE("a map names quantities and their columns") {
  const auto map = data::parse_map(kQuotedMap);
  REQUIRE(map.size() == 4);
  CHECK(map[0].quantity == Quantity::kTime);
  CHECK(map[0].columns == std::vector<std::string>{"Time [s]"});
  CHECK(map[2].columns == std::vector<std::string>{"Y, of the image"});
  CHECK(map[3].columns == std::vector<std::string>{"I1", "I2", "I3", "I4"});
}

TEST_CASE("a map that cannot be used is refused in words") {
  const auto [map, says] = GENERATE(table<std::string, std::string>({
      {"", "must be QUANTITY=..."},
      {"time", "\"time\" must be QUANTITY=..."},
      {"tmie=T,x=X,y=Y,currents=A|B", "did you mean time?"},
      {"time=T,x=X,y=Y", "currents is missing"},
      {"x=X,y=Y,currents=A|B", "time is missing"},
      {"time=T,x=X,y=Y,currents=A|B|C", "3 columns, not 4 (+x|-x|+y|-y) or 2"},
      {"time=T|U,x=X,y=Y,currents=A|B", "time has 2 columns, not 1"},
      {"time=T,x=X,y=X,currents=A|B", "\"X\" is given two meanings"},
      {"time=T,time=U,x=X,y=Y,currents=A|B", "time is given twice"},
      {"time=,x=X,y=Y,currents=A|B", "time is given nothing"},
      {"time=T,x=X,y=Y,currents=A||B|C", "a column without a name"},
      {"time=\"T,x=X,y=Y,currents=A|B", "a quote is opened and not closed"},
  }));
  CHECK_THROWS_AS(data::parse_map(map), common::ConfigError);
  CHECK_THROWS_WITH(data::parse_map(map), Contains("--map") && Contains(says));
}

TEST_CASE("units come from brackets, from the end of a name, or from an argument, which wins") {
  const auto columns = found("time=Time,x=X,y=Y [mm],heading=A,currents=I_x|I_y", "heading=deg,currents=mA",
                             {"A [rad]", "Time (ms)", "X_px", "Y [mm]", "I_x", "I_y [A]"});
  REQUIRE(columns.size() == 6);
  CHECK(columns[0].unit.name == "ms");
  CHECK(columns[0].unit.factor == 1e-3);
  CHECK(columns[0].index == 1);
  CHECK(columns[1].unit.pixels());
  CHECK(columns[2].unit.factor == 1e-3);
  CHECK(columns[3].unit.name == "deg");
  CHECK(columns[3].unit_given);
  CHECK_FALSE(columns[2].unit_given);
  CHECK(columns[5].unit.factor == 1e-3);
  CHECK(columns[5].header == "I_y [A]");
}

TEST_CASE("columns and units that are not there are named") {
  const std::vector<std::string> header = {"Time [s]", "X [mm]", "Y [inch]", "I1 [A]",
                                           "I2 [A]",   "X (m)",  "Z"};
  const auto refusal = [&](const std::string& map, const std::string& units) {
    try {
      found(map, units, header);
    } catch (const common::Error& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  CHECK_THAT(refusal("time=Tiem [s],x=X [mm],y=Z,currents=I1|I2", "y=mm"),
             Contains("log.csv:1: column \"Tiem [s]\" (time) is not in the header; did you mean Time [s]?"));
  CHECK_THAT(refusal("time=Time,x=X,y=Z,currents=I1|I2", "y=mm"), Contains("may be \"X [mm]\" or \"X (m)\""));
  CHECK_THAT(refusal("time=Time,x=X [mm],y=Z,currents=I1|I2", ""), Contains("\"Z\" (y) has no unit"));
  CHECK_THAT(refusal("time=Time,x=X [mm],y=Y,currents=I1|I2", ""),
             Contains("unit inch of y is none of m, cm, mm"));
  CHECK_THAT(refusal("time=Time,x=X [mm],y=Z,currents=I1|I2", "y=A"), Contains("--units: A of y is none of"));
  CHECK_THAT(refusal("time=Time,x=Time [s],y=Z,currents=I1|I2", "x=mm,y=mm"),
             Contains("two meanings, time and x"));
}
