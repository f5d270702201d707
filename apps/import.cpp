#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <utility>

#include "common_options.h"
#include "lodestone/common/files.h"
#include "lodestone/common/log.h"
#include "lodestone/common/named.h"
#include "lodestone/data/csv_import.h"
#include "lodestone/data/dataset_file.h"
#include "lodestone/data/mapped_import.h"
#include "lodestone/geometry/angle.h"
#include "lodestone/imaging/camera_model.h"
#include "lodestone/report/import_report.h"
#include "lodestone/rig/rig_config.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

/// How a recording is read, and the rig it is of.
struct ImportConfig {
  data::CsvImportConfig import;
  data::MapConfig map;
  rig::RigConfig rig;

  template <class Visitor>
  void visit(Visitor& v) {
    import.visit(v);
    v.group("map", map, "a log of any layout (--map)");
    v.group("rig", rig, "the rig that was recorded");
  }
};

struct ImportOptions : CommonOptions {
  std::string file;
  std::string on_error;
  std::string page;
  bool force = false;
};

constexpr double kSightLine_px = 10.0;  // how far along the needle a second point is looked for

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

/// Where pixels lie in the dish, as the camera's calibration says.
std::function<geometry::Pose2(double, double, double)> pixels_of(const std::string& calibration) {
  const imaging::CameraModel camera = imaging::read_calibration(calibration).camera;
  return [camera](double u_px, double v_px, double angle_rad) {
    const geometry::Vector2 at_m = camera.to_dish({u_px, v_px});
    const geometry::Vector2 ahead_m = camera.to_dish(
        {u_px + kSightLine_px * std::cos(angle_rad), v_px - kSightLine_px * std::sin(angle_rad)});
    const geometry::Vector2 along_m = ahead_m - at_m;
    return geometry::Pose2{at_m.x(), at_m.y(), std::atan2(along_m.y(), along_m.x())};
  };
}

/// The page beside the dataset, or where it was asked for.
std::string page_of(const ImportOptions& options) {
  if (!options.page.empty()) return options.page;
  return std::filesystem::path(options.out).replace_extension(".html").string();
}

void check_out(const ImportOptions& options, bool mapped) {
  if (options.out.empty()) throw common::ConfigError("import needs --out FILE.h5: the dataset to write");
  if (!options.page.empty() && !mapped)
    throw common::ConfigError("--page shows how --map was understood: give it, too");
  if (std::filesystem::is_directory(options.out))
    throw common::ConfigError("--out " + options.out + " is a folder: name a file, for example " +
                              options.out + "/pulses.h5");
  if (mapped && page_of(options) == options.out)
    throw common::ConfigError("--out " + options.out + " is the page's name, too: name a .h5, or --page");
  for (const std::string& file : {options.out, mapped ? page_of(options) : options.out})
    if (std::filesystem::exists(file) && std::filesystem::exists(options.file) &&
        std::filesystem::equivalent(file, options.file))
      throw common::ConfigError((file == options.out ? "--out " : "the page ") + file +
                                " is the recording itself, which stays: name another file");
  for (const std::string& file : {options.out, mapped ? page_of(options) : options.out})
    if (std::filesystem::exists(file) && !options.force)
      throw common::ConfigError((file == options.out ? "--out " : "the page ") + file +
                                " exists already: name a new file, or give --force");
}

/// Recordings have a column for each of four coils, or for each of two pairs.
void check_drive(const rig::RigConfig& rig) {
  if (rig.drive.kind == physics::DriveKind::kOpposedPairs) return;
  throw common::ConfigError(
      "rig.drive.kind = " + common::name_of(rig.drive.kind) +
      ": import reads recordings of opposed_pairs, whose actions are two currents; name "
      "such a rig, or record this one with `lodestone collect`");
}

void warn(const data::CsvImportResult& result) {
  for (const std::string& problem : result.problems) common::log_warning("skipped " + problem);
  const std::int64_t unreported = result.skipped - static_cast<std::int64_t>(result.problems.size());
  if (unreported > 0) common::log_warning("skipped " + std::to_string(unreported) + " more malformed rows");
  for (const std::string& position : result.impossible) common::log_warning("left out " + position);
}

void write(const std::string& file, const data::Dataset& dataset) {
  const std::string folder = std::filesystem::path(file).parent_path().string();
  if (!folder.empty()) common::make_folders(folder);
  data::write_dataset(file, dataset);
}

void import_known(const ImportOptions& options, const ImportConfig& config) {
  const data::CsvImportResult result = data::import_csv(options.file, config.import);
  warn(result);
  write(options.out, result.dataset);
  print_import(result);
}

void import_with_map(const ImportOptions& options, ImportConfig config) {
  if (!config.map.calibration.empty()) config.map.to_dish = pixels_of(config.map.calibration);
  const data::MappedImport imported = data::import_mapped(options.file, config.import, config.map);
  warn(imported.result);
  write(options.out, imported.result.dataset);
  report::write_import_report(imported, options.file, page_of(options));
  print_import(imported.result);
  std::printf("pulses       of %.4f s, from rows %.4f s apart; %zu stretches of time left out\n",
              imported.cut.period_s, imported.cut.spacing_s, imported.cut.left_out.size());
  std::printf("understood   %s\n", page_of(options).c_str());
}

void run_import(const ImportOptions& options) {
  CommonOptions resolved = options;
  if (!options.on_error.empty()) resolved.overrides.push_back({"on_error=" + options.on_error, "--on-error"});
  auto config = resolve_config<ImportConfig>(resolved);
  const bool mapped = !config.map.columns.empty();
  check_out(options, mapped);
  check_drive(config.rig);
  config.import.max_current_A = config.rig.coils.max_current_A;
  config.import.full_drive_A = config.rig.full_drive_A;
  config.import.dish_radius_m = config.rig.dish.radius_m;
  config.import.rig = common::config_to_json<physics::RigDescription>(config.rig);
  if (mapped)
    import_with_map(options, std::move(config));
  else
    import_known(options, config);
  std::printf("written to   %s\n", options.out.c_str());
}

}  // namespace

void add_import(Verb& program) {
  Verb& verb = program.add_verb("import", "turn a CSV recording into a dataset of transitions (.h5)");
  auto& options = configure<ImportConfig>(verb, run_import);
  verb.add_option(
          "file", &options.file,
          "CSV with the columns coil, drive_percent, x_before_mm, y_before_mm, x_after_mm, y_after_mm, "
          "or the lab's log (camera_frame_number, measured_current_filtered_north..., localization_x...); "
          "with "
          "--map any log")
      .named("FILE.csv")
      .required();
  add_shorthand(
      verb, options, "--map", "map.columns", Shorthand::kText,
      "which columns mean what: time=Time [s],x=X_px,y=Y_px,heading=A [deg],currents=+X|-X|+Y|-Y (the "
      "columns of the coils in this order, or of the pairs x|y)");
  add_shorthand(verb, options, "--units", "map.units", Shorthand::kText,
                "units that the header does not say: time=ms,x=px,y=px,heading=rad,currents=%");
  add_shorthand(verb, options, "--pixel-m", "map.pixel_m", Shorthand::kValue,
                "length of a pixel on the dish floor, m");
  add_shorthand(verb, options, "--calibration", "map.calibration", Shorthand::kText,
                "calibration.json of the camera whose pixels positions are in");
  verb.add_option("--page", &options.page,
                  "page that shows how --map was understood (default: --out with the ending .html)")
      .named("FILE.html");
  verb.add_option("--on-error", &options.on_error, "what a malformed row does (default abort)")
      .named("skip|abort")
      .one_of({"skip", "abort"});
  verb.add_option("--force", &options.force, "replace --out when it exists");
  add_common_options(verb, options);
}

}  // namespace lodestone::apps
