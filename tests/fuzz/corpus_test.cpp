// What fuzzing and hand-made attacks broke once: every file is refused by name, for good.
#include <filesystem>

#include "fuzz.h"
#include "lodestone/common/config_layers.h"
#include "lodestone/data/csv_import.h"
#include "lodestone/experiments/deployment_job.h"

using namespace lodestone;

namespace {

template <class Read>
void check_refused(const std::string& kind, const Read& read) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::string(LODESTONE_SOURCE_DIR) +
                                                               "/tests/fuzz/corpus/" + kind)) {
    const std::string path = entry.path().string();
    CAPTURE(path);
    ++files;
    std::string said;
    try {
      read(path);
    } catch (const common::Error& error) {
      said = error.what();
    }
    CHECK_FALSE(said.empty());
    CHECK(said.size() < 2000);
    CHECK(said.find('\x1b') == std::string::npos);
  }
  CHECK(files >= 6);
}

}  // namespace

TEST_CASE("configurations that broke something once are refused by name") {
  check_refused("config", [](const std::string& path) {
    common::ConfigLayers layers;
    layers.add_file(path);
    common::config_from_json<experiments::DeployConfig>(layers.json(), layers.sources());
  });
}

TEST_CASE("recordings that broke something once are refused by name") {
  check_refused("csv", [](const std::string& path) {
    data::CsvImportConfig config;
    config.max_current_A = 15.0;
    config.dish_radius_m = 0.0425;
    data::import_csv(path, config);
  });
}
