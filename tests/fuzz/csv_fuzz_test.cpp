#include "fuzz.h"
#include "lodestone/data/csv_import.h"
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
