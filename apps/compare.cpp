#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/report/comparison_report.h"
#include "lodestone/runs/comparison.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

struct CompareOptions {
  std::vector<std::string> runs;
  std::string out = "comparison";
};

void compare(const CompareOptions& options) {
  if (options.runs.size() < 2)
    throw common::ConfigError(
        "compare: name two runs at least, the one that the others are held against first");
  std::vector<runs::ComparedRun> read;
  for (const std::string& run : options.runs) read.push_back(runs::read_compared_run(run));
  const runs::Comparison comparison = runs::compare_runs(read);
  common::make_folders(options.out);
  common::write_artefact(options.out + "/" + runs::Comparison::kFile, comparison);
  std::printf("%s", report::write_comparison_report(comparison, options.out + "/report.html").c_str());
  std::printf("report   %s/report.html\n", options.out.c_str());
}

}  // namespace

void add_compare(Verb& program) {
  Verb& verb =
      program.add_verb("compare", "hold runs of deploy or bench rigs against the first, trial by trial");
  const auto options = std::make_shared<CompareOptions>();
  verb.add_option(
          "runs", &options->runs,
          "folders that deploy or bench rigs wrote with the same seed; FOLDER:CONTROLLER where several "
          "controllers drove, as runs/any:baseline")
      .named("DIR")
      .required();
  verb.add_option("--out", &options->out, "folder of report.html and comparison.json")
      .named("DIR")
      .with_default();
  verb.run = [options] { compare(*options); };
}

}  // namespace lodestone::apps
