#include "lodestone/data/mapped_log.h"

#include <catch2/catch.hpp>

#include "fuzz/fuzz.h"
#include "lodestone/common/error.h"
#include "lodestone/geometry/angle.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

constexpr const char* kFour = "time=T [s],x=X [mm],y=Y [mm],currents=E [A]|W [A]|N [A]|S [A]";
const std::string kFourHeader = "T [s],X [mm],Y [mm],E [A],W [A],N [A],S [A],more\n";

struct Read {
  data::MappedLog log;
  data::CsvImportResult result;
};

Read read(const std::string& text, data::MapConfig map, data::CsvImportConfig config = {}) {
  const tests::TemporaryFolder folder;
  tests::write_bytes(folder / "log.csv", text);
  if (map.columns.empty()) map.columns = kFour;
  config.max_current_A = 15.0;
  config.dish_radius_m = 0.0425;
  Read out;
  out.log = data::read_mapped_log(folder / "log.csv", config, map, out.result);
  return out;
}

std::string refusal(const std::string& text, const data::MapConfig& map = {}) {
  try {
    read(text, map);
  } catch (const common::Error& error) {
    return error.what();
  }
  return "nothing";
}

}  // namespace

TEST_CASE("rows come in SI units, and what means nothing is listed") {
  const Read found = read(kFourHeader + "0.5,10,-20,5,0,0,2,a\n0.8,11,-21,0,0.01,3,0,b\n", {});
  REQUIRE(found.log.samples.size() == 2);
  const data::LogSample& sample = found.log.samples[0];
  CHECK(sample.time_s == 0.5);
  CHECK(sample.pose.x_m == Approx(0.010));
  CHECK(sample.pose.y_m == Approx(-0.020));
  CHECK(sample.drive.x() == 5.0);
  CHECK(sample.drive.y() == -2.0);
  CHECK(sample.line == 2);
  CHECK(found.log.samples[1].drive.x() == 0.0);  // noise
  CHECK(found.log.ignored == std::vector<std::string>{"more"});
  CHECK(found.log.first_rows.at(1) == std::vector<std::string>{"0.8", "11", "-21", "0", "0.01", "3", "0"});
  CHECK(found.log.action_unit == "A");
  CHECK(found.log.action_scale == 15.0);
  CHECK_FALSE(found.log.heading);
}

TEST_CASE("separator and decimal sign are found, whatever they are") {
  for (const char separator : {';', '\t', '|'})
    for (const char decimal : {'.', ','}) {
      std::string text =
          "T [s],X [mm],Y [mm],E [A],W [A],N [A],S [A],more\n0:5,10,-20:25,5,0,0,2,a\n1,11,-21:5,0,0,3,0,b\n";
      std::replace(text.begin(), text.end(), ',', separator);
      std::replace(text.begin(), text.end(), ':', decimal);
      const Read found = read(text, {});
      CAPTURE(separator, decimal);
      CHECK(found.log.format.separator == separator);
      CHECK(found.log.format.decimal == decimal);
      CHECK(found.log.samples.at(0).pose.y_m == Approx(-0.02025));
    }
  data::MapConfig map;
  map.columns = "time=1,x=2,y=3,heading=4,currents=5|6";
  map.units = "time=ms,x=m,y=m,heading=deg,currents=mA";
  map.header_line = 0;
  map.negative_current = data::NegativeCurrent::kOpposite;
  const Read found = read("10 0.01 0.02 270 5000 -2000\n20  0.01 0.02  -90\t0 0\n", map);
  REQUIRE(found.log.samples.size() == 2);
  CHECK(found.log.samples[0].time_s == Approx(0.01));
  CHECK(found.log.samples[0].pose.heading_rad == Approx(-geometry::kPi / 2.0));
  CHECK(found.log.samples[0].drive.y() == Approx(-2.0));
  CHECK(found.log.most_turned_rad == Approx(1.5 * geometry::kPi));
}

TEST_CASE("a current below zero is refused, or drives the opposite coil where that is said") {
  const std::string text = kFourHeader + "0,1,1,-5,0,0,0,a\n1,1,1,0,-4,0,0,a\n2,1,1,5,-4,0,0,a\n";
  CHECK_THAT(refusal(text),
             Contains("log.csv:2: column 4 (E [A])") && Contains("map.negative_current=opposite"));
  data::MapConfig map;
  map.negative_current = data::NegativeCurrent::kOpposite;
  const Read found = read(text, map);
  CHECK(found.log.samples[0].drive.x() == -5.0);
  CHECK(found.log.samples[1].drive.x() == 4.0);
  CHECK(found.log.samples[2].drive.x() == 9.0);
  CHECK(found.log.reversed == 3);
}

TEST_CASE("opposite coils on together are refused, or their difference counts where that is said") {
  const std::string text = kFourHeader + "0,1,1,5,2,0,0,a\n1,1,1,0,0,3,3,a\n";
  CHECK_THAT(refusal(text),
             Contains("column 5 (W [A])") && Contains("E [A] = 5") && Contains("map.opposite_currents=net"));
  data::MapConfig map;
  map.opposite_currents = data::OppositeCurrents::kNet;
  const Read found = read(text, map);
  CHECK(found.log.samples[0].drive.x() == 3.0);
  CHECK(found.log.samples[1].drive.y() == 0.0);
  CHECK(found.log.netted == 2);
}

TEST_CASE("per cent stay per cent, or become ampere where the rig says of what") {
  data::MapConfig map;
  map.columns = "time=T [s],x=X [mm],y=Y [mm],currents=E|W|N|S";
  map.units = "currents=%";
  const std::string text = "T [s],X [mm],Y [mm],E,W,N,S\n0,1,1,50,0,0,100\n";
  const Read percent = read(text, map);
  CHECK(percent.log.action_unit == "percent");
  CHECK(percent.log.action_scale == 100.0);
  CHECK(percent.log.samples[0].drive.x() == 50.0);
  data::CsvImportConfig config;
  config.full_drive_A = 8.0;
  const Read ampere = read(text, map, config);
  CHECK(ampere.log.action_unit == "A");
  CHECK(ampere.log.action_scale == 8.0);
  CHECK(ampere.log.samples[0].drive.x() == Approx(4.0));
  CHECK(ampere.log.samples[0].drive.y() == Approx(-8.0));
  CHECK_THAT(refusal("T [s],X [mm],Y [mm],E,W,N,S\n0,1,1,150,0,0,0\n", map), Contains("within -100 .. 100"));
}

TEST_CASE("pixels need their size or a calibration, and y may point down") {
  const std::string text = "T [s],X_px,Y_px,A [rad],E [A],W [A],N [A],S [A]\n0,700,500,0.5,5,0,0,0\n";
  data::MapConfig map;
  map.columns = "time=T,x=X,y=Y,heading=A,currents=E|W|N|S";
  CHECK_THAT(refusal(text, map), Contains("--calibration") && Contains("--pixel-m"));
  map.pixel_m = 1e-4;
  data::CsvImportConfig config;
  config.centre_x = 640.0;
  config.centre_y = 512.0;
  config.y_down = true;
  const geometry::Pose2 pose = read(text, map, config).log.samples.at(0).pose;
  CHECK(pose.x_m == Approx(6e-3));
  CHECK(pose.y_m == Approx(1.2e-3));
  CHECK(pose.heading_rad == Approx(-0.5));
  map.pixel_m = 0.0;
  map.to_dish = [](double u, double v, double angle) { return geometry::Pose2{u, v, angle}; };
  CHECK_THROWS_WITH(read(text, map, config), Contains("centre_x and centre_y must be 0"));
  config.centre_x = config.centre_y = 0.0;
  CHECK(read(text, map, config).log.samples.at(0).pose.heading_rad == -0.5);
  CHECK_THAT(refusal(kFourHeader,
                     [&] {
                       data::MapConfig metres = map;
                       metres.columns = kFour;
                       return metres;
                     }()),
             Contains("pixels have no use"));
}

TEST_CASE("what a person gets wrong in a file is told with its place") {
  CHECK_THAT(refusal(kFourHeader + "0,1,1,5,0,0,0,a\n0.3,1,1,5,0,0,0,a\n0.2,1,1,5,0,0,0,a\n"),
             Contains("log.csv:4: column 1 (T [s]): \"0.2\" must be later than the row before (line 3)"));
  CHECK_THAT(refusal(kFourHeader + "0,1,1,5000,0,0,0,a\n"),
             Contains("column 4 (E [A])") && Contains("-18 .. 18 A"));
  CHECK_THAT(refusal(kFourHeader + "0,1,north,5,0,0,0,a\n"),
             Contains("log.csv:2: column 3 (Y [mm]): \"north\""));
  CHECK_THAT(refusal(kFourHeader + "0,5,1,1,5,0,0,0,0,a\n"),
             Contains("decimal commas need another separator"));
  data::MapConfig map;
  map.separator = data::Separator::kSemicolon;
  CHECK_THAT(refusal(kFourHeader + "0,1,1,5,0,0,0,a\n", map),
             Contains("one column only with separator semicolon"));
  map.separator = data::Separator::kAuto;
  map.decimal = data::Decimal::kComma;
  CHECK_THAT(refusal(kFourHeader + "0.5,1,1,5,0,0,0,a\n", map), Contains("a number with a decimal comma"));
  map = {};
  map.columns = "time=T [s],x=Xx,y=Y [mm],currents=E [A]|W [A]|N [A]|S [A]";
  CHECK_THAT(refusal(kFourHeader + "0,1,1,5,0,0,0,a\n", map),
             Contains("column \"Xx\" (x) is not in the header") && Contains("X [mm]"));
  CHECK_THAT(refusal("", {}), Contains("empty"));
  CHECK_THAT(refusal("T;X;Y\n1;2;3\n", {}), Contains("\"T [s]\" (time) is not in the header"));
}

TEST_CASE("malformed rows are left out where that is asked for") {
  data::CsvImportConfig config;
  config.on_error = data::OnError::kSkip;
  const Read found =
      read(kFourHeader + "0,1,1,5,0,0,0,a\n0.1,x,1,5,0,0,0,a\n0.2,1,1,5,0,0,0,a\n", {}, config);
  CHECK(found.log.samples.size() == 2);
  CHECK(found.result.rows == 3);
  CHECK(found.result.skipped == 1);
}
