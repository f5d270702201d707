#include "lodestone/data/mapped_import.h"

#include <catch2/catch.hpp>

#include "fuzz/fuzz.h"
#include "lodestone/common/error.h"
#include "odd_log.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

constexpr const char* kOddMap = "time=Time,x=X,y=Y,heading=Angle,currents=I_east|I_west|I_north|I_south";

data::MappedImport import_log(const std::string& csv, data::MapConfig map = {},
                              data::CsvImportConfig config = {}) {
  const tests::TemporaryFolder folder;
  tests::write_bytes(folder / "odd.csv", csv);
  if (map.columns.empty()) map.columns = kOddMap;
  config.max_current_A = 15.0;
  config.dish_radius_m = 0.0425;
  return data::import_mapped(folder / "odd.csv", config, map);
}

/// The driven steps are those that happened, within what is seen at irregular times.
void check_truth(const data::MappedImport& imported, const tests::OddLog& truth) {
  const data::TransitionTable table = data::flatten(imported.result.dataset);
  REQUIRE(table.size() == static_cast<std::int64_t>(truth.pulses.size()));
  for (std::size_t i = 0; i < truth.pulses.size(); ++i) {
    const tests::TruePulse& pulse = truth.pulses[i];
    const double* state = &table.state[3 * i];
    const double* next = &table.next_state[3 * i];
    CAPTURE(i);
    for (std::size_t axis = 0; axis < 2; ++axis)
      CHECK(std::abs(table.action[2 * i + axis] - pulse.drive_A[static_cast<int>(axis)]) <
            0.03 * std::abs(pulse.drive_A[static_cast<int>(axis)]) + 0.05);
    CHECK(std::hypot(state[0] - pulse.before.x_m, state[1] - pulse.before.y_m) < 0.8e-3);
    CHECK(std::hypot(next[0] - pulse.after.x_m, next[1] - pulse.after.y_m) < 0.8e-3);
    CHECK(std::abs(geometry::wrap_angle(next[2] - pulse.after.heading_rad)) < 0.1);
  }
}

}  // namespace

TEST_CASE("irregular rows with slow currents become the pulses that happened") {
  const tests::OddLog log;
  const data::MappedImport imported = import_log(log.csv);
  check_truth(imported, log);
  CHECK(imported.cut.period_s == Approx(0.3).margin(0.035));
  CHECK(imported.result.dataset.info.control_period_s == imported.cut.period_s);
  CHECK(imported.result.dataset.info.action_unit == "A");
  CHECK(imported.directions.as_is == imported.directions.best);
  CHECK(imported.log.ignored == std::vector<std::string>{"note"});
}

TEST_CASE("the same log in other clothes gives the same pulses") {
  tests::OddLogStyle style;
  style.separator = ';';
  style.decimal = ',';
  style.header = "t_ms,u_px,v_px,phi_rad,coil_x,coil_y,note";
  style.time = 1e3;
  style.length = 1.0 / 9e-5;
  style.angle = 1.0;
  style.current = 100.0 / 15.0;
  style.centre = 640.0;
  style.y_down = true;
  style.signed_pairs = true;
  const tests::OddLog log(style);
  data::MapConfig map;
  map.columns = "time=t,x=u,y=v,heading=phi,currents=coil_x|coil_y";
  map.units = "currents=%";
  map.pixel_m = 9e-5;
  map.negative_current = data::NegativeCurrent::kOpposite;
  data::CsvImportConfig config;
  config.centre_x = config.centre_y = 640.0;
  config.y_down = true;
  config.full_drive_A = 15.0;
  check_truth(import_log(log.csv, map, config), log);
}

TEST_CASE("a stated length of a pulse is used") {
  data::CsvImportConfig config;
  config.control_period_s = 0.3;
  const tests::OddLog log;
  const data::MappedImport imported = import_log(log.csv, {}, config);
  CHECK(imported.cut.period_s == 0.3);
  check_truth(imported, log);
}

TEST_CASE("a sphere has no heading") {
  data::MapConfig map;
  map.columns = "time=Time,x=X,y=Y,currents=I_east|I_west|I_north|I_south";
  const data::MappedImport imported = import_log(tests::OddLog().csv, map);
  CHECK(imported.result.dataset.info.layout == data::StateLayout::kPosition);
  CHECK(data::flatten(imported.result.dataset).size() == 60);
}

TEST_CASE("exchanged columns and wrong units are refused by what they lead to") {
  const auto [columns, units, says] = GENERATE(table<std::string, std::string, std::string>({
      {"time=Time,x=Y [mm],y=X [mm],heading=Angle,currents=I_east|I_west|I_north|I_south", "",
       "x and y, or the pairs of currents, are exchanged"},
      {"time=Time,x=X,y=Y,heading=Angle,currents=I_west|I_east|I_north|I_south", "",
       "x is the other way round"},
      {"time=Time,x=X,y=Y,heading=Angle,currents=I_east|I_west|I_south|I_north", "", "set y_down"},
      {"time=Time,x=X,y=Y,heading=Angle,currents=I_north|I_south|I_east|I_west", "", "are exchanged"},
      {kOddMap, "x=cm,y=cm", "outside the dish of 42.5 mm"},
      {kOddMap, "x=um,y=um", "no position is further than"},
      {kOddMap, "heading=rad", "headings reach"},
      {kOddMap, "currents=mA", "no current is above"},
      {kOddMap, "time=ms", "correct the unit of time"},
      {"time=X,x=Time,y=Y,heading=Angle,currents=I_east|I_west|I_north|I_south", "time=s,x=mm",
       "must be later than the row before"},
  }));
  data::MapConfig map;
  map.columns = columns;
  map.units = units;
  CHECK_THROWS_WITH(import_log(tests::OddLog().csv, map), Contains("odd.csv") && Contains(says));
}

TEST_CASE("what looks implausible is taken where that is said") {
  data::MapConfig map;
  map.columns = "time=Time,x=X,y=Y,heading=Angle,currents=I_west|I_east|I_north|I_south";
  data::CsvImportConfig config;
  config.plausible = false;
  CHECK(import_log(tests::OddLog().csv, map, config).directions.best_way.find("x is the other way") == 0);
}
