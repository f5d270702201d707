#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "common_options.h"
#include "lodestone/common/files.h"
#include "lodestone/common/log.h"
#include "lodestone/data/csv_import.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/rig/rig_config.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

/// How a recording is read, and the rig it is of.
struct ImportConfig {
  data::CsvImportConfig import;
  rig::RigConfig rig;

  template <class Visitor>
  void visit(Visitor& v) {
    import.visit(v);
    v.group("rig", rig, "the rig that was recorded");
  }
};

struct ImportOptions : CommonOptions {
  std::string file;
  std::string on_error;
  bool force = false;
};

void print_range(const char* name, const std::vector<double>& values, std::size_t first, std::size_t stride,
                 double factor, const char* unit) {
  double low = values[first];
  double high = low;
  for (std::size_t i = first; i < values.size(); i += stride) {
    low = std::min(low, values[i]);
    high = std::max(high, values[i]);
  }
  std::printf("%-12s %.3f to %.3f %s\n", name, low * factor, high * factor, unit);
}

void print_import(const data::CsvImportResult& result) {
  const data::Dataset& dataset = result.dataset;
  const bool pose = dataset.info.layout == data::StateLayout::kPose;
  const data::TransitionTable table = data::flatten(dataset, true);
  const auto s = static_cast<std::size_t>(table.state_size);
  const std::int64_t driven = data::flatten(dataset).size();
  std::printf("layout       %s (state %s)\n", result.layout.c_str(), pose ? "x, y, heading" : "x, y");
  std::printf("rows         %lld read, %lld skipped, %lld without a following row\n",
              static_cast<long long>(result.rows), static_cast<long long>(result.skipped),
              static_cast<long long>(result.unpaired));
  std::printf("transitions  %lld (%lld with current)\n", static_cast<long long>(table.size()),
              static_cast<long long>(driven));
  std::printf("episodes     %zu\n", dataset.episodes.size());
  if (!dataset.impossible.empty())
    std::printf(
        "left out     %zu transitions from or to a position where nothing can be (impossible=keep keeps "
        "them)\n",
        dataset.impossible.size());
  print_range("x", table.state, 0, s, 1e3, "mm");
  print_range("y", table.state, 1, s, 1e3, "mm");
  if (pose) print_range("heading", table.state, 2, s, 180.0 / geometry::kPi, "deg");
  print_range("drive x", table.action, 0, 2, 1.0, dataset.info.action_unit.c_str());
  print_range("drive y", table.action, 1, 2, 1.0, dataset.info.action_unit.c_str());
  std::printf("workspace    radius %.3f mm\n", dataset.info.workspace_radius_m * 1e3);
}

void run_import(const ImportOptions& options) {
  if (options.out.empty()) throw common::ConfigError("import needs --out FILE.h5: the dataset to write");
  if (std::filesystem::is_directory(options.out))
    throw common::ConfigError("--out " + options.out + " is a folder: name a file, for example " +
                              options.out + "/pulses.h5");
  if (std::filesystem::exists(options.out) && !options.force)
    throw common::ConfigError("--out " + options.out + " exists already: name a new file, or give --force");
  CommonOptions resolved = options;
  if (!options.on_error.empty()) resolved.overrides.push_back({"on_error=" + options.on_error, "--on-error"});
  auto [config, rig] = resolve_config<ImportConfig>(resolved);
  config.max_current_A = rig.coils.max_current_A;
  config.dish_radius_m = rig.dish.radius_m;
  config.rig = common::config_to_json<physics::RigDescription>(rig);
  const data::CsvImportResult result = data::import_csv(options.file, config);
  for (const std::string& problem : result.problems) common::log_warning("skipped " + problem);
  const std::int64_t unreported = result.skipped - static_cast<std::int64_t>(result.problems.size());
  if (unreported > 0) common::log_warning("skipped " + std::to_string(unreported) + " more malformed rows");
  for (const std::string& position : result.impossible) common::log_warning("left out " + position);
  const std::string folder = std::filesystem::path(options.out).parent_path().string();
  if (!folder.empty()) common::make_folders(folder);
  data::write_dataset(options.out, result.dataset);
  print_import(result);
  std::printf("written to   %s\n", options.out.c_str());
}

}  // namespace

void add_import(Verb& program) {
  Verb& verb = program.add_verb("import", "turn a CSV recording into a dataset of transitions (.h5)");
  auto& options = configure<ImportConfig>(verb, run_import);
  verb.add_option(
          "file", &options.file,
          "CSV with the columns coil, drive_percent, x_before_mm, y_before_mm, x_after_mm, y_after_mm, "
          "or the lab's log (camera_frame_number, measured_current_filtered_north..., localization_x...)")
      .named("FILE.csv")
      .required();
  verb.add_option("--on-error", &options.on_error, "what a malformed row does (default abort)")
      .named("skip|abort")
      .one_of({"skip", "abort"});
  verb.add_option("--force", &options.force, "replace --out when it exists");
  add_common_options(verb, options);
}

}  // namespace lodestone::apps
