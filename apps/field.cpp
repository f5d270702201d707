#include <cstdio>
#include <memory>
#include <string>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/physics/field_fit.h"
#include "lodestone/rig/rig_config.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

struct CalibrateFieldOptions {
  std::string samples;
  std::string out = "field.json";
  std::string rig_file;
};

/// What an error of the field means for the needle that lies in it: most where the error is across it.
void print_torque(const physics::FieldError& error, const rig::RigConfig& rig) {
  // Friction on a rod that turns about its middle: its weight, spread evenly, at a quarter of the length.
  const double breakaway_N_m = 0.25 * rig.breakaway_N() * rig.needle.length_m;
  const double torque_N_m = rig.needle.moment_A_m2 * error.rms_T;
  std::printf(
      "to a needle of %.3g A m^2 that is a torque of at most %.2g N m, %.2g of what turns it from rest\n",
      rig.needle.moment_A_m2, torque_N_m, torque_N_m / breakaway_N_m);
}

void calibrate_field(const CalibrateFieldOptions& options) {
  rig::RigConfig rig;  // the paper's, where none is named
  if (!options.rig_file.empty())
    rig =
        common::config_from_json<rig::RigConfig>(common::read_json_file(options.rig_file), options.rig_file);
  const physics::FieldSamples samples = physics::read_field_samples(options.samples);
  physics::FieldFit fit;
  try {
    fit = physics::fit_field(samples);
  } catch (const common::DataError& error) {
    throw common::DataError(options.samples + ": " + error.what());
  }
  common::write_artefact(options.out, fit.field);
  std::printf("%lld samples of %zu coils; share of the field left by solid harmonics of degree\n",
              static_cast<long long>(fit.fitted.samples), samples.coils);
  for (std::size_t i = 0; i < fit.held_out_by_degree.size(); ++i)
    std::printf("  %zu  %7.3f %% of samples held out%s\n", i + 1, 100.0 * fit.held_out_by_degree[i],
                static_cast<std::int64_t>(i + 1) == fit.field.degree ? "  <- taken" : "");
  std::printf(
      "left of held-out samples %.3g mT (%.2f %%), its direction off by %.2f degrees (95 %%: below %.2f)\n",
      1e3 * fit.held_out.rms_T, 100.0 * fit.held_out.relative_rms, fit.held_out.direction_median_deg,
      fit.held_out.direction_p95_deg);
  print_torque(fit.held_out, rig);
  std::printf("field    %s\n", options.out.c_str());
}

struct EvaluateFieldOptions {
  std::string field;
  std::string data;
};

void evaluate_field(const EvaluateFieldOptions& options) {
  const auto field = common::read_artefact<physics::MeasuredField>(options.field);
  const physics::FieldSamples samples = physics::read_field_samples(options.data);
  physics::FieldError error;
  try {
    error = physics::field_error(field, samples);
  } catch (const common::DataError& fault) {
    throw common::DataError(options.data + ": " + fault.what());
  }
  std::printf("%s\n", common::artefact_to_json(error).dump(2).c_str());
}

}  // namespace

void add_calibrate_field(Verb& calibrate) {
  Verb& verb =
      calibrate.add_verb("field", "fit the field of any coils, with cores too, to a magnetometer's samples");
  const auto options = std::make_shared<CalibrateFieldOptions>();
  verb.add_option("samples", &options->samples,
                  "CSV with x_m,y_m,z_m (or _mm), current_1_A,current_2_A,..., Bx_T,By_T,Bz_T (or _mT, _uT)")
      .named("FILE.csv")
      .required();
  verb.add_option("--out", &options->out, "where the field is written").named("FILE").with_default();
  verb.add_option("--rig", &options->rig_file,
                  "rig.json: whose needle the residual is told for; without it the paper's")
      .named("FILE");
  verb.run = [options] { calibrate_field(*options); };
}

void add_evaluate_field(Verb& evaluate) {
  Verb& verb = evaluate.add_verb("field", "how far a fitted field is from samples that it has not seen");
  const auto options = std::make_shared<EvaluateFieldOptions>();
  verb.add_option("--field", &options->field, "field.json of calibrate field").named("FILE").required();
  verb.add_option("--data", &options->data, "samples, as for calibrate field").named("FILE.csv").required();
  verb.run = [options] { evaluate_field(*options); };
}

}  // namespace lodestone::apps
