#include <cstdio>

#include "common_options.h"
#include "lodestone/common/files.h"
#include "lodestone/common/log.h"
#include "lodestone/geometry/path.h"
#include "lodestone/rig/field_map.h"
#include "lodestone/rig/rig_config.h"
#include "verbs.h"

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

struct FieldOptions : CommonOptions {
  std::string coil;
  std::string points;
  std::string plot;
};

void field(const FieldOptions& options) {
  const auto config = resolve_config<FieldConfig>(options);
  const physics::CoilsDescription& coils = config.rig.coils;
  const std::size_t coil = rig::coil_index(coils, options.coil);
  const std::vector<geometry::Vector2> points = geometry::read_points_csv(options.points);
  const std::string csv = rig::field_csv(points, rig::field_per_ampere(coils, coil, points));
  if (!options.plot.empty()) {
    rig::write_field_plot(options.plot, coils, coil, config.rig.dish.radius_m, points);
    common::log_info("rig field: wrote " + options.plot);
  }
  if (options.out.empty()) {
    std::fputs(csv.c_str(), stdout);
  } else {
    common::write_file_atomically(options.out, csv);
    common::log_info("rig field: wrote " + options.out);
  }
}

}  // namespace

void add_rig(Verb& program) {
  Verb& rig = program.add_verb("rig", "look at the rig itself: its field, its wiring, or an emulated one");
  add_rig_check(rig);
  add_rig_emulate(rig);
  add_rig_conform(rig);
  Verb& verb = rig.add_verb("field",
                            "exact field per ampere of one coil in the dish plane (CSV to --out "
                            "or standard output), to compare with a "
                            "gaussmeter");
  auto& options = configure<FieldConfig>(verb, field);
  add_common_options(verb, options);
  verb.add_option("--coil", &options.coil, "which coil: +x, -x, +y or -y, or a name of rig.coils.each")
      .named("NAME")
      .required();
  verb.add_option("--points", &options.points,
                  "CSV with the columns x_m,y_m: points of the dish plane in metres from its centre")
      .named("FILE")
      .required();
  verb.add_option("--plot", &options.plot, "also draw the field over the dish (mT/A) into this image")
      .named("PNG");
}

}  // namespace lodestone::apps
