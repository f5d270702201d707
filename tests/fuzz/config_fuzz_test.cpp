#include <filesystem>

#include "fuzz.h"
#include "lodestone/common/config_layers.h"
#include "lodestone/experiments/deployment_job.h"
#include "lodestone/imaging/camera_model.h"
#include "lodestone/rl/policy_trainer.h"
#include "lodestone/runs/plan.h"
#include "temporary_folder.h"

using namespace lodestone;

namespace {

/// Every preset, plan and rig file, and all keys of two verbs.
std::vector<std::string> configurations() {
  std::vector<std::string> texts;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::string(LODESTONE_SOURCE_DIR) + "/configs"))
    if (entry.path().extension() == ".json") texts.push_back(common::read_file(entry.path().string()));
  texts.push_back(common::config_to_json(experiments::DeployConfig()).dump(1));
  texts.push_back(common::config_to_json(rl::TrainPolicyConfig()).dump(1));
  std::sort(texts.begin(), texts.end());
  return texts;
}

template <class Config>
bool reads(const common::ConfigLayers& layers) {
  try {
    common::config_from_json<Config>(layers.json(), layers.sources());
    return true;
  } catch (const common::ConfigError& error) {
    if (std::string(error.what()).size() > 2000) FAIL("a message without end: " << error.what());
    return false;
  }
}

}  // namespace

TEST_CASE("a spoiled configuration is read or refused by name", "[soak]") {
  const tests::Soak soak("spoiled configurations, plans and overrides", 1000, 100'000);
  const tests::TemporaryFolder folder;
  const std::vector<std::string> good = configurations();
  tests::Spoiler spoiler(soak.seed(), "configurations");
  std::string text;
  std::string assignment;
  const std::int64_t accepted = tests::fuzz(
      soak,
      [&] {
        const std::string& from = spoiler.one_of(good);
        if (spoiler.below(2) == 0)
          text = spoiler.json(common::parse_json(from, "good")).dump();
        else
          text = spoiler.bytes(from, spoiler.one_of(good));
        tests::write_bytes(folder / "a.json", text);
        assignment = spoiler.bytes("trials.count=[1, 2.5]", from).substr(0, 100'000);
      },
      [&] {
        common::ConfigLayers override;
        try {
          override.set(assignment, "--set");
        } catch (const common::ConfigError&) {  // one of two things that are fuzzed here
        }
        reads<experiments::DeployConfig>(override);
        common::ConfigLayers layers;
        layers.add_file(folder / "a.json");
        const bool deploy = reads<experiments::DeployConfig>(layers);
        const bool train = reads<rl::TrainPolicyConfig>(layers);
        if (!deploy && !train) runs::read_plan(folder / "a.json");
      });
  CHECK(accepted > soak.count() / 100);
  CHECK(accepted < soak.count() / 2);
}

TEST_CASE("a spoiled calibration is read or refused by name", "[soak]") {
  const tests::Soak soak("spoiled calibrations", 1000, 100'000);
  const tests::TemporaryFolder folder;
  imaging::Calibration calibration;
  calibration.method = "dish";
  const common::Json good = imaging::to_json(calibration);
  tests::Spoiler spoiler(soak.seed(), "calibrations");
  const std::int64_t accepted = tests::fuzz(
      soak,
      [&] {
        const std::string text =
            spoiler.below(2) == 0 ? spoiler.json(good).dump() : spoiler.bytes(good.dump(), good.dump());
        tests::write_bytes(folder / "a.json", text);
      },
      [&] {
        const imaging::CameraModel camera = imaging::read_calibration(folder / "a.json").camera;
        CHECK(std::isfinite(camera.pixel_size_m()));
      });
  CHECK(accepted > soak.count() / 100);
  CHECK(accepted < soak.count() / 2);
}
