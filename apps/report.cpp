#include <cstdio>
#include <filesystem>
#include <memory>

#include "lodestone/common/error.h"
#include "lodestone/report/report.h"
#include "lodestone/report/rigs_report.h"
#include "lodestone/runs/rigs_result.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

struct ReportOptions {
  std::string run;
  std::string recorded;
  std::string out;
};

void run_report(const ReportOptions& options) {
  const std::string out = options.out.empty() ? options.run + "/report.html" : options.out;
  if (std::filesystem::is_directory(out))
    throw common::ConfigError("--out " + out + " is a folder: name the page, for example " + out +
                              "/report.html");
  const bool rigs = std::filesystem::exists(options.run + "/" + runs::RigsResult::kFile);
  if (rigs && !options.recorded.empty())
    throw common::ConfigError("--recorded: " + options.run +
                              " is of bench rigs, which nothing is shown beside");
  if (rigs)
    report::write_rigs_report(options.run, out);
  else
    report::write_report(options.run, options.recorded, out);
  std::printf("%s\n", out.c_str());
}

}  // namespace

void add_report(Verb& program) {
  Verb& verb = program.add_verb("report", "write one self-contained HTML page about a run");
  const auto options = std::make_shared<ReportOptions>();
  verb.add_option(
          "--run", &options->run,
          "folder of the run: its subfolders collect, dynamics, policy and deploy are shown as far as they "
          "are there; summary.json and table.txt are written into it")
      .named("DIR")
      .required();
  verb.add_option("--recorded", &options->recorded, "folder of a run on real recordings, shown beside it")
      .named("DIR");
  verb.add_option("--out", &options->out, "the page (default DIR/report.html)").named("FILE.html");
  verb.run = [options] { run_report(*options); };
}

}  // namespace lodestone::apps
