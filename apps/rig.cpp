#include <cstdio>
#include <memory>

#include "lodestone/common/files.h"
#include "lodestone/common/log.h"
#include "lodestone/geometry/path.h"
#include "lodestone/rig/field_map.h"
#include "lodestone/rig/rig_config.h"
#include "rig_check.h"
#include "verb.h"

namespace lodestone::apps {
namespace {

/// Configuration of `rig field`.
struct FieldConfig {
  rig::RigConfig rig;

  template <class Visitor>
  void visit(Visitor& v) {
    v.group("rig", rig, "the rig");
  }
};

struct FieldOptions {
  CommonOptions common;
  std::string coil;
  std::string points;
  std::string plot;
};

void field(const FieldOptions& options) {
  const auto config = resolve_config<FieldConfig>(options.common);
  const int coil = rig::coil_index(options.coil);
  const std::vector<geometry::Vector2> points = geometry::read_points_csv(options.points);
  const std::string csv =
      rig::field_csv(points, rig::field_per_ampere(config.rig.coils.geometry, coil, points));
  if (!options.plot.empty()) {
    rig::write_field_plot(options.plot, config.rig.coils.geometry, coil, config.rig.dish.radius_m, points);
    common::log_info("rig field: wrote " + options.plot);
  }
  if (options.common.out.empty()) {
    std::fputs(csv.c_str(), stdout);
  } else {
    common::write_file_atomically(options.common.out, csv);
    common::log_info("rig field: wrote " + options.common.out);
  }
}

}  // namespace

void add_rig(CLI::App& program, ConfigCatalogue& catalogue) {
  CLI::App* verb =
      program.add_subcommand("rig", "look at the rig itself: its field, its wiring, or an emulated one");
  verb->require_subcommand(1);
  add_rig_check(*verb, catalogue);
  add_rig_emulate(*verb, catalogue);

  CLI::App* map = verb->add_subcommand("field",
                                       "exact field per ampere of one coil in the dish plane (CSV to --out "
                                       "or standard output), to compare with a "
                                       "gaussmeter");
  auto options = std::make_shared<FieldOptions>();
  catalogue["rig field"] = [options] { return describe_resolved<FieldConfig>(options->common); };
  add_common_options(*map, options->common);
  map->add_option("--coil", options->coil, "which coil: +x, -x, +y or -y")->type_name("NAME")->required();
  map->add_option("--points", options->points,
                  "CSV with the columns x_m,y_m: points of the dish plane in metres from its centre")
      ->type_name("FILE")
      ->required();
  map->add_option("--plot", options->plot, "also draw the field over the dish (mT/A) into this image")
      ->type_name("PNG");
  map->callback([options] { field(*options); });
}

}  // namespace lodestone::apps
