#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include "common_options.h"
#include "lodestone/common/artefact.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/experiments/qualification.h"
#include "lodestone/nets/blas.h"
#include "lodestone/report/qualification_report.h"
#include "lodestone/runs/resumable_run.h"
#include "models.h"
#include "terminal.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

using experiments::QualificationConfig;

struct QualifyOptions : CommonOptions {
  bool yes = false;
  bool virtual_rig = false;
};

std::unique_ptr<session::RigSession> open_bench(const QualificationConfig& config,
                                                const QualifyOptions& options, const std::string& folder) {
  if (!config.rig.real()) return experiments::make_qualification_session(config);
  char question[160];
  std::snprintf(question, sizeof question,
                "qualify this bench? For up to %g minutes its coils get pulses of up to %g A, and the "
                "needle, which lies in the dish, is driven about.",
                config.minutes, std::min(config.safety.max_current_A, config.rig.coils.max_current_A));
  if (!confirm(question, options.yes)) throw common::Interrupted("qualify: stopped; nothing was measured");
  return session::make_bench_session(config.rig, config.sensor, config.safety, terminal_operator(config.rig),
                                     folder);
}

/// Writes the page from what lies in the run's folder, and says what it says.
void print_verdicts(const runs::RunFolder& run) {
  const std::string page = run.file("report.html");
  const std::string text = report::write_qualification_report(run.path(), page);
  std::printf("%sreport   %s\n", text.c_str(), page.c_str());
}

void measure_bench(const QualificationConfig& config, const experiments::ControllerSource& driver,
                   const QualifyOptions& options, runs::RunFolder& run) {
  const std::unique_ptr<session::RigSession> bench = open_bench(config, options, run.path());
  experiments::Qualification work(config, *bench, driver);
  runs::run_resumably(run, work, {"qualify", "s of the bench", 0.0});
  const runs::QualificationResult result = work.result();
  const std::string file = run.file(runs::QualificationResult::kFile);
  common::write_artefact(file, result);
  print_verdicts(run);
  if (!result.stopped) return run.finish();
  const std::string kept =
      "; what was measured until then is in " + file + ", and the same command with --resume goes on";
  if (common::interrupted()) throw common::Interrupted("qualify: stopped" + kept);
  throw common::HardwareError("qualify: stopped: " + *result.stopped + kept);
}

void qualify(const QualifyOptions& given) {
  QualifyOptions options = given;
  if (options.virtual_rig) options.overrides.push_back({"rig.backend=virtual", "--virtual"});
  auto config = resolve_config<QualificationConfig>(options);
  nets::use_one_blas_thread();
  choose_segmenter(config.sensor);
  const experiments::ControllerSource driver = experiments::points_source(config);
  runs::RunRequest request{options.out, "qualify", common::config_to_json(config), config.seed,
                           options.resume};
  request.free_keys = {"threads", "rig.serial.port"};
  request.inputs =
      runs::named_inputs(request.config, {"points.policy", "points.dynamics", "sensor.segmenter"});
  runs::RunFolder run(request);
  if (!run.finished()) return measure_bench(config, driver, options, run);
  common::log_info("qualify: " + run.path() + " is finished already");
  print_verdicts(run);
}

}  // namespace

void add_qualify(Verb& program) {
  Verb& verb = program.add_verb("qualify",
                                "what a bench can do, in at most 15 minutes of it: a verdict per item, "
                                "what to mend first, and the error to expect");
  auto& options = configure<QualificationConfig>(verb, qualify);
  add_common_options(verb, options, /*with_resume=*/true);
  add_virtual_rig_options(verb, options);
  add_shorthand(verb, options, "--port", "rig.serial.port", Shorthand::kText,
                "serial port of the coil controller, such as /dev/ttyACM0");
  add_shorthand(verb, options, "--minutes", "minutes", Shorthand::kValue,
                "of the bench, at most; with fewer there is less of every item");
  add_points_models_option(verb, options);
  add_shorthand(verb, options, "--policy", "points.policy", Shorthand::kText,
                "folder of the policy checkpoint that drives to the points at the end");
  add_shorthand(verb, options, "--controller", "points.controller", Shorthand::kText,
                "what drives there: planner, policy or baseline");
  add_shorthand(verb, options, "--sensor", "sensor.kind", Shorthand::kText, "camera or simulated");
  verb.add_option("--virtual", &options.virtual_rig, "on a simulated rig, whatever rig.json says");
  verb.add_option("--yes", &options.yes, "answer every question with yes: coils will be energised");
}

}  // namespace lodestone::apps
