#include <cstdio>
#include <memory>
#include <string>

#include "lodestone/common/artefact.h"
#include "lodestone/common/config.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/physics/coil_fit.h"
#include "lodestone/physics/field_fit.h"
#include "lodestone/rig/rig_config.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

struct CalibrateFieldOptions {
  std::string samples;
  std::string out = "rig.json";
  std::string rig_file;
  bool coils = false;
};

rig::RigConfig read_rig(const std::string& file) {
  if (file.empty()) return {};  // the paper's
  auto rig = common::config_from_json<rig::RigConfig>(common::read_json_file(file), file);
  rig.validate();
  return rig;
}

/// Runs what reads samples, so that its errors name their file.
template <class Work>
auto of_file(const std::string& file, const Work& work) {
  try {
    return work();
  } catch (const common::DataError& error) {
    throw common::DataError(file + ": " + error.what());
  }
}

/// What an error of the field means for the needle that lies in it: most where the error is across it.
void print_torque(const physics::FieldError& error, const rig::RigConfig& rig) {
  // Friction on a rod that turns about its middle: its weight, spread evenly, at a quarter of the length.
  const double breakaway_N_m = 0.25 * rig.breakaway_N() * rig.needle.length_m;
  const double torque_N_m = rig.needle.moment_A_m2 * error.rms_T;
  std::printf(
      "to a needle of %.3g A m^2 that is a torque of at most %.2g N m, %.2g of what turns it from rest\n",
      rig.needle.moment_A_m2, torque_N_m, torque_N_m / breakaway_N_m);
}

void print_left(const physics::FieldError& error) {
  std::printf(
      "left of held-out samples %.3g mT (%.2f %%), its direction off by %.2f degrees (95 %%: below %.2f)\n",
      1e3 * error.rms_T, 100.0 * error.relative_rms, error.direction_median_deg, error.direction_p95_deg);
}

/// The rig with the coils that samples tell of. Throws DataError where it cannot be one.
void write_rig(const CalibrateFieldOptions& options, const rig::RigConfig& rig) {
  try {
    rig.coils.validate();
    rig.validate();
  } catch (const common::ConfigError& error) {
    throw common::DataError(options.samples +
                            ": with the coils that fit best, the rig is none: " + error.what());
  }
  common::write_file_atomically(options.out, common::config_to_json(rig).dump(1) + "\n");
}

/// The coils of a rig where samples say that they stand.
void calibrate_coil_places(const CalibrateFieldOptions& options, rig::RigConfig rig,
                           const physics::FieldSamples& samples) {
  if (rig.coils.each.empty())
    throw common::ConfigError(
        "calibrate field --coils places coils that a rig lists: name one by --rig whose coils.each does "
        "(docs/bring-your-own-rig.md)");
  const physics::CoilFit fit =
      of_file(options.samples, [&] { return physics::fit_coils(rig.coils, samples); });
  rig.coils = fit.coils;
  write_rig(options, rig);
  std::printf("%lld samples; as described the coils leave %.1f %% of the field\n",
              static_cast<long long>(fit.fitted.samples), 100.0 * fit.described.relative_rms);
  std::printf("%-8s %26s %12s %8s\n", "coil", "moved by x, y, z in mm", "tilted by", "gain");
  for (const physics::CoilShift& shift : fit.shifts)
    std::printf("%-8s %8.2f %8.2f %8.2f %8.2f deg %8.3f\n", shift.name.c_str(), 1e3 * shift.moved_m[0],
                1e3 * shift.moved_m[1], 1e3 * shift.moved_m[2], shift.tilted_deg, shift.gain);
  std::printf("without current there are %.1f, %.1f, %.1f uT\n", 1e6 * fit.background_T[0],
              1e6 * fit.background_T[1], 1e6 * fit.background_T[2]);
  print_left(fit.held_out);
  print_torque(fit.held_out, rig);
}

/// The coils of a rig with the field that samples say they have, whatever makes it.
void calibrate_coil_fields(const CalibrateFieldOptions& options, rig::RigConfig rig,
                           const physics::FieldSamples& samples) {
  const physics::FieldFit fit = of_file(options.samples, [&] { return physics::fit_field(samples); });
  rig.coils = of_file(options.samples, [&] { return fit.field.applied_to(rig.coils); });
  rig.drive.kind = physics::DriveKind::kField;  // of any coils
  write_rig(options, rig);
  std::printf("%lld samples of %zu coils; share of the field left by solid harmonics of degree\n",
              static_cast<long long>(fit.fitted.samples), samples.coils);
  for (std::size_t i = 0; i < fit.held_out_by_degree.size(); ++i)
    std::printf("  %zu  %7.3f %% of samples held out%s\n", i + 1, 100.0 * fit.held_out_by_degree[i],
                static_cast<std::int64_t>(i + 1) == fit.degree ? "  <- taken" : "");
  print_left(fit.held_out);
  print_torque(fit.held_out, rig);
  std::printf("it holds up to %.1f mm from the dish centre in the needle's plane\n",
              1e3 * fit.field.region.disc_radius_m());
}

void calibrate_field(const CalibrateFieldOptions& options) {
  const rig::RigConfig rig = read_rig(options.rig_file);
  const physics::FieldSamples samples = physics::read_field_samples(options.samples);
  if (options.coils)
    calibrate_coil_places(options, rig, samples);
  else
    calibrate_coil_fields(options, rig, samples);
  std::printf("rig      %s, for --rig\n", options.out.c_str());
}

struct EvaluateFieldOptions {
  std::string rig_file;
  std::string data;
};

void evaluate_field(const EvaluateFieldOptions& options) {
  const rig::RigConfig rig = read_rig(options.rig_file);
  const physics::FieldSamples samples = physics::read_field_samples(options.data);
  const physics::FieldError error =
      of_file(options.data, [&] { return physics::field_error(rig.coils, samples); });
  std::printf("%s\n", common::artefact_to_json(error).dump(2).c_str());
}

}  // namespace

void add_calibrate_field(Verb& calibrate) {
  Verb& verb =
      calibrate.add_verb("field", "fit the coils of a rig to a magnetometer's samples of their field");
  const auto options = std::make_shared<CalibrateFieldOptions>();
  verb.add_option("samples", &options->samples,
                  "CSV with x_m,y_m,z_m (or _mm), current_1_A,current_2_A,..., Bx_T,By_T,Bz_T (or _mT, _uT)")
      .named("FILE.csv")
      .required();
  verb.add_option("--out", &options->out, "the rig that is written").named("FILE").with_default();
  verb.add_option("--rig", &options->rig_file,
                  "rig.json: whose coils were measured, in the order of the samples' currents; the paper's "
                  "without it")
      .named("FILE");
  verb.add_option("--coils", &options->coils,
                  "the coils are windings without cores: fit their places, tilts and gains; else their "
                  "field is fitted as it is, with cores too");
  verb.run = [options] { calibrate_field(*options); };
}

void add_evaluate_field(Verb& evaluate) {
  Verb& verb =
      evaluate.add_verb("field", "how far the field of a rig's coils is from a magnetometer's samples");
  const auto options = std::make_shared<EvaluateFieldOptions>();
  verb.add_option("--rig", &options->rig_file,
                  "rig.json: the coils as it describes them; the paper's without it")
      .named("FILE");
  verb.add_option("--data", &options->data, "samples, as for calibrate field").named("FILE.csv").required();
  verb.run = [options] { evaluate_field(*options); };
}

}  // namespace lodestone::apps
