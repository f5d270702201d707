#include "lodestone/data/csv_import.h"

#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "lodestone/common/error.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/geometry/angle.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

const std::string kPulses = "coil,drive_percent,x_before_mm,y_before_mm,x_after_mm,y_after_mm\n";
const std::string kLog =
    "camera_frame_number,measured_current_filtered_north,measured_current_filtered_south,"
    "measured_current_filtered_east,measured_current_filtered_west,localization_x,localization_y,"
    "localization_angle\n";

/// As the program imports a recording of the paper's rig.
data::CsvImportResult import_text(const std::string& text, data::CsvImportConfig config = {}) {
  if (config.max_current_A == 0.0) config.max_current_A = 15.0;
  if (config.dish_radius_m == 0.0) config.dish_radius_m = 0.0425;
  const tests::TemporaryFolder folder;
  const std::string path = folder / "log.csv";
  std::ofstream(path, std::ios::binary) << text;
  return data::import_csv(path, config);
}

data::CsvImportConfig skipping() {
  data::CsvImportConfig config;
  config.on_error = data::OnError::kSkip;
  return config;
}

}  // namespace

TEST_CASE("pulses become episodes, chained where one starts as the last ended") {
  const data::CsvImportResult result = import_text(kPulses +
                                                   "+x,40,1,2,3,4\n"
                                                   "-x,20,3,4,2,4\n"
                                                   "-y,54,-1.5,13,-1,12\n"
                                                   "+y,0,5,5,5,5\n");
  CHECK(result.layout == "pulses");
  CHECK(result.rows == 4);
  const data::Dataset& dataset = result.dataset;
  CHECK(dataset.info.layout == data::StateLayout::kPosition);
  CHECK(dataset.info.action_unit == "percent");
  CHECK(dataset.info.action_scale == 100.0);
  CHECK(dataset.info.one_axis_at_a_time);
  REQUIRE(dataset.episodes.size() == 3);
  CHECK(dataset.episodes[0].observations == std::vector<double>{0.001, 0.002, 0.003, 0.004, 0.002, 0.004});
  CHECK(dataset.episodes[0].actions == std::vector<double>{40.0, 0.0, -20.0, 0.0});
  CHECK(dataset.episodes[0].truncations == std::vector<std::uint8_t>{0, 1});
  CHECK(dataset.episodes[1].actions == std::vector<double>{0.0, -54.0});
  CHECK(dataset.episodes[2].zero_current == std::vector<std::uint8_t>{1});
}

TEST_CASE("a byte order mark, CRLF, quotes, blank lines and any column order are read") {
  const data::CsvImportResult result = import_text(
      "\xEF\xBB\xBFnote, x_after_mm ,\"y_after_mm\",coil,drive_percent,x_before_mm,y_before_mm\r\n"
      "\"a, b\",3,4,\"+y\", +40 ,1,2\r\n\r\n");
  REQUIRE(result.dataset.transitions() == 1);
  CHECK(result.dataset.episodes[0].observations == std::vector<double>{0.001, 0.002, 0.003, 0.004});
  CHECK(result.dataset.episodes[0].actions == std::vector<double>{0.0, 40.0});
}

TEST_CASE("every kind of malformed row is reported with line and column") {
  const auto [row, place] = GENERATE(table<std::string, std::string>({
      {"+x,abc,1,2,3,4", "log.csv:3: column 2 (drive_percent)"},
      {"+x,40,,2,3,4", "log.csv:3: column 3 (x_before_mm)"},
      {"+x,40,1,nan,3,4", "log.csv:3: column 4 (y_before_mm)"},
      {"+x,40,1,2,inf,4", "log.csv:3: column 5 (x_after_mm)"},
      {"+x,40,1,2,3,4mm", "log.csv:3: column 6 (y_after_mm)"},
      {"+x,40,1,2,3,1e999", "log.csv:3: column 6 (y_after_mm)"},
      {"north,40,1,2,3,4", "log.csv:3: column 1 (coil)"},
      {"+x,140,1,2,3,4", "log.csv:3: column 2 (drive_percent)"},
      {"+x,-5,1,2,3,4", "log.csv:3: column 2 (drive_percent)"},
      {"+x,40,1,2,3", "log.csv:3: column 6 (y_after_mm) is missing"},
      {"+x,40,1,2,3,4,5", "log.csv:3: column 7 is one too many"},
  }));
  const std::string text = kPulses + "+x,40,1,2,3,4\n" + row + "\n-y,10,3,4,3,3\n";
  CHECK_THROWS_AS(import_text(text), common::DataError);
  CHECK_THROWS_WITH(import_text(text), Contains(place));
  const data::CsvImportResult result = import_text(text, skipping());
  CHECK(result.rows == 3);
  CHECK(result.skipped == 1);
  CHECK(result.dataset.transitions() == 2);
  CHECK(result.dataset.episodes.size() == 2);  // a skipped row breaks the chain
  REQUIRE(result.problems.size() == 1);
  CHECK_THAT(result.problems[0], Contains(place));
}

TEST_CASE("reports of skipped rows stop at the limit, the count does not") {
  std::string text = kPulses + "+x,40,1,2,3,4\n";
  for (int i = 0; i < 10; ++i) text += "+x,,1,2,3,4\n";
  data::CsvImportConfig config = skipping();
  config.max_reported = 3;
  const data::CsvImportResult result = import_text(text, config);
  CHECK(result.skipped == 10);
  CHECK(result.problems.size() == 3);
}

TEST_CASE("files without a usable header or row are refused") {
  CHECK_THROWS_WITH(import_text("a,b\n1,2\n"), Contains("a, b") && Contains("pulses") && Contains("lab log"));
  CHECK_THROWS_WITH(import_text("coil,coil\n"), Contains("twice"));
  CHECK_THROWS_AS(import_text(""), common::DataError);
  CHECK_THROWS_WITH(import_text(kPulses), Contains("no transition"));
  CHECK_THROWS_WITH(import_text(kPulses + "+x,,1,2,3,4\n", skipping()), Contains("no transition"));
  CHECK_THROWS_WITH(data::import_csv("no-such.csv", {}), Contains("no-such.csv"));
}

TEST_CASE("the lab's log: currents act up to the next row, gaps end an episode") {
  data::CsvImportConfig config;
  config.angle_unit = data::AngleUnit::kDeg;
  const data::CsvImportResult result = import_text(kLog +
                                                       "10,0,0,5,0.01,1,2,90\n"
                                                       "11,0,3,0,7,2,2,180\n"
                                                       "12,1,0,0,0,3,2,-270\n"
                                                       "20,0,0,0,0,0,0,0\n"
                                                       "21,9,0,0,0,0,1,0\n"
                                                       "40,0,0,0,0,0,0,0\n",
                                                   config);
  CHECK(result.layout == "lab log");
  const data::Dataset& dataset = result.dataset;
  CHECK(dataset.info.layout == data::StateLayout::kPose);
  CHECK(dataset.info.action_unit == "A");
  CHECK_FALSE(dataset.info.one_axis_at_a_time);
  REQUIRE(dataset.episodes.size() == 2);
  CHECK(dataset.episodes[0].actions == std::vector<double>{5.0, 0.0, -7.0, -3.0});
  CHECK(dataset.episodes[0].observations[0] == Approx(0.001));
  CHECK(dataset.episodes[0].observations[2] == Approx(geometry::kPi / 2));
  CHECK(dataset.episodes[0].observations[8] == Approx(geometry::kPi / 2));
  CHECK(dataset.episodes[1].zero_current == std::vector<std::uint8_t>{1});
  CHECK(result.unpaired == 3);
}

TEST_CASE("the lab's log in metres, off centre, with y pointing down") {
  data::CsvImportConfig config;
  config.position_unit = data::PositionUnit::kM;
  config.centre_x = 0.05;
  config.centre_y = 0.04;
  config.y_down = true;
  const data::CsvImportResult result =
      import_text(kLog + "1,2,0,0,0,0.06,0.03,1.0\n2,0,0,0,0,0.06,0.03,1.0\n", config);
  const std::vector<double>& seen = result.dataset.episodes.at(0).observations;
  CHECK(seen[0] == Approx(0.01));
  CHECK(seen[1] == Approx(0.01));
  CHECK(seen[2] == Approx(-1.0));
}

TEST_CASE("rows of the lab's log that cannot be true are malformed") {
  const auto [row, place] = GENERATE(table<std::string, std::string>({
      {"2,3,4,0,0,1,2,0", "column 3 (measured_current_filtered_south)"},
      {"2,0,0,6,6,1,2,0", "column 5 (measured_current_filtered_west)"},
      {"2,-3,0,0,0,1,2,0", "column 2 (measured_current_filtered_north)"},
      {"2,30,0,0,0,1,2,0", "column 2 (measured_current_filtered_north)"},
      {"2.5,0,0,0,0,1,2,0", "column 1 (camera_frame_number)"},
  }));
  const std::string text =
      kLog + "0,1,0,0,0,1,2,0\n1,1,0,0,0,1,2,0\n" + row + "\n3,1,0,0,0,1,2,0\n4,1,0,0,0,1,2,0\n";
  CHECK_THROWS_WITH(import_text(text), Contains("log.csv:4: " + place));
  const data::CsvImportResult result = import_text(text, skipping());
  CHECK(result.skipped == 1);
  CHECK(result.dataset.episodes.size() == 2);
}

TEST_CASE("any dataset is read by its ending") {
  const tests::TemporaryFolder folder;
  std::ofstream(folder / "a.csv") << kPulses << "+x,40,1,2,3,4\n";
  CHECK(data::read_any_dataset(folder / "a.csv").transitions() == 1);
}

TEST_CASE("positions where nothing can be are listed with file and line, and left out") {
  std::string text = kLog;
  for (int i = 0; i < 60; ++i)
    text += std::to_string(i) + ",0,0,5,0," + (i == 30 ? "61" : std::to_string(0.1 * i)) + ",2,0\n";
  const data::CsvImportResult result = import_text(text);
  REQUIRE(result.impossible.size() == 1);
  CHECK_THAT(result.impossible[0], Contains("log.csv:32: ") && Contains("61."));
  CHECK(result.dataset.transitions() == 57);  // the step to it and the step from it are missing
  CHECK(result.dataset.episodes.size() == 2);
  CHECK(result.dataset.impossible.size() == 2);
  data::CsvImportConfig config;
  config.impossible = data::Impossible::kKeep;
  CHECK(import_text(text, config).dataset.transitions() == 59);

  const tests::TemporaryFolder folder;
  data::write_dataset(folder / "d.h5", result.dataset);
  const data::Dataset again = data::read_dataset(folder / "d.h5");
  CHECK(again.transitions() == 57);
  REQUIRE(again.impossible.size() == 2);
  CHECK(again.impossible[0].observations == result.dataset.impossible[0].observations);
}

TEST_CASE("where the dish is not known, a position far beyond all others is a glitch") {
  std::string text = kPulses;
  for (int i = 0; i < 100; ++i) {
    const std::string from = std::to_string(i % 13);
    const std::string to = i == 50 ? "72" : std::to_string((i + 1) % 13);
    text += "+x,40," + from + ",0," + to + ",0\n";
  }
  const data::CsvImportResult result = import_text(text);
  REQUIRE(result.impossible.size() == 1);
  CHECK_THAT(result.impossible[0], Contains("log.csv:52: "));
  CHECK(result.dataset.transitions() == 99);
  CHECK(result.dataset.info.workspace_radius_m == Approx(0.012));
}

TEST_CASE("many positions outside the dish mean a wrong unit or centre") {
  std::string text = kLog;
  for (int i = 0; i < 60; ++i) text += std::to_string(i) + ",5,0,0,0,500,2,0\n";
  CHECK_THROWS_WITH(import_text(text),
                    Contains("60 of 60 positions") && Contains("line 2") && Contains("position_unit"));
}

TEST_CASE("a position or an angle that nothing could measure is a malformed row") {
  CHECK_THROWS_WITH(import_text(kPulses + "+x,40,0,0,1e303,0\n"),
                    Contains("log.csv:2: column 5 (x_after_mm)"));
  CHECK_THROWS_WITH(import_text(kPulses + "+x,40,+-1,0,1,0\n"), Contains("\"+-1\" must be a number"));
  CHECK_THROWS_WITH(import_text(kLog + "1,5,0,0,0,1,2,1e300\n"), Contains("log.csv:2: column 8"));
  CHECK(import_text(kPulses + "+x,40,0,0,1e303,0\n+x,40,5,0,6,0\n", skipping()).skipped == 1);
}

TEST_CASE("a lab's log whose sizes or directions cannot be is refused, and taken where that is said") {
  // A needle that follows its coil; 40 rows.
  const auto log = [](double unit, double angle, int sign, double current) {
    std::string text = kLog;
    for (int i = 0; i < 40; ++i)
      text += fmt::format("{},0,0,{},{},{},0,{}\n", i, sign > 0 ? current : 0.0, sign > 0 ? 0.0 : current,
                          unit * i, angle);
    return text;
  };
  CHECK(import_text(log(1.0, 1.0, 1, 5.0)).dataset.transitions() == 39);
  data::CsvImportConfig taken;
  taken.plausible = false;
  const auto [text, fault] = GENERATE_COPY(table<std::string, std::string>({
      {log(1e-3, 1.0, 1, 5.0), "no position is further than 0.039 mm"},
      {log(1.0, 90.0, 1, 5.0), "headings reach 90 rad"},
      {log(1.0, 1.0, 1, 0.5), "no current is above 0.5 A"},
      {log(1.0, 1.0, -1, 5.0), "x is the other way round"},
  }));
  CHECK_THROWS_WITH(import_text(text), Contains("log.csv: ") && Contains(fault));
  CHECK(import_text(text, taken).dataset.transitions() == 39);
}

TEST_CASE("pulses that lead away from the coils that are on are refused") {
  std::string text = kPulses;
  for (int i = 0; i < 40; ++i) text += "+x,40,5,0,2,0\n-y,30,0,-3,0,1\n";
  CHECK_THROWS_WITH(import_text(text), Contains("x and y are the other way round"));
}
