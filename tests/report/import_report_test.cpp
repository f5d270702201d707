#include "lodestone/report/import_report.h"

#include <catch2/catch.hpp>

#include "data/odd_log.h"
#include "fuzz/fuzz.h"
#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

TEST_CASE("the page of an import shows what was understood, and what was left out and why") {
  const tests::TemporaryFolder folder;
  tests::OddLogStyle style;
  style.header = "Time [s],X [mm],Y [mm],Angle [deg],I_east [A],I_west [A],I_north [A],I_south [A],<b>note";
  std::string log = tests::OddLog(style).csv;
  log.insert(log.find('\n', log.size() / 2) + 1, "oh dear\n");
  tests::write_bytes(folder / "odd.csv", log);
  data::MapConfig map;
  map.columns = "time=Time,x=X,y=Y,heading=Angle,currents=I_east|I_west|I_north|I_south";
  data::CsvImportConfig config;
  config.max_current_A = 15.0;
  config.dish_radius_m = 0.0425;
  config.on_error = data::OnError::kSkip;
  config.control_period_s = 0.29;
  const data::MappedImport imported = data::import_mapped(folder / "odd.csv", config, map);
  report::write_import_report(imported, folder / "odd.csv", folder / "odd.html");
  const std::string html = common::read_file(folder / "odd.html");
  CHECK_THAT(html, Contains("How odd.csv was understood"));
  for (const char* text :
       {"current of coil -x", "I_west [A]", "the header", "Columns that mean nothing here: &lt;b&gt;note",
        "heading (degrees)", "drive y (A)", "60 pulses</b>", "1 malformed rows were skipped",
        "column 2 (X [mm]) is missing", "polyline", "as cut into pulses", "0.2900 s (control_period_s)"})
    CHECK_THAT(html, Contains(text));
  CHECK_THAT(html, !Contains("<b>note"));
}

TEST_CASE("what a log means by choice is told on its page") {
  const tests::TemporaryFolder folder;
  tests::OddLogStyle style;
  style.header = "t [s],x [mm],y [mm],a [deg],i_x [A],i_y [A],note";
  style.signed_pairs = true;
  tests::write_bytes(folder / "odd.csv", tests::OddLog(style).csv);
  data::MapConfig map;
  map.columns = "time=t,x=x,y=y,currents=i_x|i_y";
  map.negative_current = data::NegativeCurrent::kOpposite;
  data::CsvImportConfig config;
  config.max_current_A = 15.0;
  config.dish_radius_m = 0.0425;
  report::write_import_report(data::import_mapped(folder / "odd.csv", config, map), "odd.csv",
                              folder / "odd.html");
  const std::string html = common::read_file(folder / "odd.html");
  CHECK_THAT(html, Contains("current of the pair x"));
  CHECK_THAT(html, Contains("a current below zero drives the opposite coil"));
  CHECK_THAT(html, !Contains("heading (degrees)"));
}
