#include <cstdio>
#include <memory>
#include <string>

#include "lodestone/report/figure_files.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

struct FiguresOptions {
  std::string page;
  std::string out = "figures";
};

void figures(const FiguresOptions& options) {
  for (const std::string& name : report::save_figures(options.page, options.out))
    std::printf("%s/%s.csv, and as drawings\n", options.out.c_str(), name.c_str());
}

}  // namespace

void add_figures(Verb& program) {
  Verb& verb = program.add_verb("figures",
                                "save the figures of a report as SVG, PDF and CSV, for a journal's columns");
  const auto options = std::make_shared<FiguresOptions>();
  verb.add_option("page", &options->page, "a page that report, compare, sweep, bench or import wrote")
      .named("FILE.html")
      .required();
  verb.add_option("--out", &options->out,
                  "folder of NAME.csv, NAME-85mm.svg, NAME-85mm.pdf (one column) and NAME-175mm (two)")
      .named("DIR")
      .with_default();
  verb.run = [options] { figures(*options); };
}

}  // namespace lodestone::apps
