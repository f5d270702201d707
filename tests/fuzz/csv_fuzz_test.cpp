#include "data/odd_log.h"
#include "fuzz.h"
#include "lodestone/data/csv_import.h"
#include "lodestone/data/mapped_import.h"
#include "temporary_folder.h"

using namespace lodestone;

TEST_CASE("a spoiled recording in CSV is imported or refused by name", "[soak]") {
  const tests::Soak soak("spoiled CSV recordings", 1000, 100'000);
  const tests::TemporaryFolder folder;
  std::string pulses = "coil,drive_percent,x_before_mm,y_before_mm,x_after_mm,y_after_mm\n";
  std::string log =
      "camera_frame_number,measured_current_filtered_north,measured_current_filtered_south,"
      "measured_current_filtered_east,measured_current_filtered_west,localization_x,localization_y,"
      "localization_angle\n";
  for (int i = 0; i < 20; ++i) {
    const std::string n = std::to_string(i);
    pulses += (i % 2 == 0 ? "+x,40," : "\"-y\",25.5,") + n + ",0," + std::to_string(i + 1) + ",0\r\n";
    log += n + ",5,0,0.25,0," + n + ",-2.5e0,1." + n + "\n";
  }
  tests::Spoiler spoiler(soak.seed(), "csv");
  data::CsvImportConfig config;
  config.max_current_A = 15.0;
  config.dish_radius_m = 0.0425;
  const std::int64_t accepted = tests::fuzz(
      soak,
      [&] {
        const bool of_pulses = spoiler.below(2) == 0;
        tests::write_bytes(folder / "a.csv",
                           spoiler.bytes(of_pulses ? pulses : log, of_pulses ? log : pulses));
        config.on_error = spoiler.below(2) == 0 ? data::OnError::kAbort : data::OnError::kSkip;
        config.impossible = spoiler.below(2) == 0 ? data::Impossible::kKeep : data::Impossible::kLeaveOut;
      },
      [&] { data::import_csv(folder / "a.csv", config); });
  CHECK(accepted > soak.count() / 100);
  CHECK(accepted < soak.count());
}

TEST_CASE("a spoiled log of any layout, or a spoiled map, is imported or refused by name", "[soak]") {
  const tests::Soak soak("spoiled mapped logs", 1000, 100'000);
  const tests::TemporaryFolder folder;
  const std::string columns =
      "time=Time [s],x=X,y=\"Y [mm]\",heading=Angle,currents=I_east|I_west|I_north|I_south";
  const std::string units = "x=mm,heading=deg,currents=A";
  tests::OddLogStyle style;
  style.pulses = 3;
  const std::string log = tests::OddLog(style).csv;
  style.separator = ';';
  style.decimal = ',';
  const std::string other = tests::OddLog(style).csv;
  tests::Spoiler spoiler(soak.seed(), "mapped log");
  data::CsvImportConfig config;
  config.max_current_A = 15.0;
  config.dish_radius_m = 0.0425;
  data::MapConfig map;
  const std::int64_t accepted = tests::fuzz(
      soak,
      [&] {
        tests::write_bytes(folder / "a.csv", spoiler.bytes(spoiler.below(2) == 0 ? log : other, other));
        map.columns = spoiler.below(4) == 0 ? spoiler.bytes(columns, units) : columns;
        map.units = spoiler.below(8) == 0 ? spoiler.bytes(units, columns) : units;
        map.header_line = static_cast<std::int64_t>(spoiler.below(8) == 0 ? spoiler.below(4) : 1);
        config.plausible = spoiler.below(2) == 0;
        map.negative_current =
            spoiler.below(2) == 0 ? data::NegativeCurrent::kRefuse : data::NegativeCurrent::kOpposite;
        map.opposite_currents =
            spoiler.below(2) == 0 ? data::OppositeCurrents::kRefuse : data::OppositeCurrents::kNet;
        config.control_period_s = spoiler.below(4) == 0 ? 1e-3 : 0.0;
        map.pulse_s = spoiler.below(4) == 0 ? 0.1 : 0.0;
        config.on_error = spoiler.below(2) == 0 ? data::OnError::kAbort : data::OnError::kSkip;
        config.impossible = spoiler.below(2) == 0 ? data::Impossible::kKeep : data::Impossible::kLeaveOut;
      },
      [&] { data::import_mapped(folder / "a.csv", config, map); });
  CHECK(accepted > soak.count() / 100);
  CHECK(accepted < soak.count());
}
