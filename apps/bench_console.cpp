#include <algorithm>
#include <cstdio>
#include <utility>

#include "bounds.h"
#include "common_options.h"
#include "lodestone/common/statistics.h"
#include "lodestone/console/console_bench.h"
#include "lodestone/nets/blas.h"
#include "lodestone/runs/run_folder.h"
#include "models.h"
#include "verbs.h"

namespace lodestone::apps {
namespace {

using console::ConsoleBench;
using console::ConsoleBenchConfig;
using console::ConsoleBenchResult;

void print_starts(const ConsoleBenchResult& result) {
  std::printf("  first image after %.2f s (median of %zu, largest %.2f)\n",
              common::percentile(result.first_image_s, 0.5), result.first_image_s.size(),
              common::percentile(result.first_image_s, 1.0));
}

void print_one_page(const ConsoleBenchResult& result) {
  std::printf("  one page: %.1f images/s, %.0f ms old (median; p99 %.0f), server %.1f %% of a processor\n",
              *result.images_per_s, *result.image_median_ms, *result.image_p99_ms,
              100.0 * *result.server_share);
  std::printf("  click to first pulse %.0f ms (median of %zu, largest %.0f)\n",
              common::percentile(result.click_ms, 0.5), result.click_ms.size(),
              common::percentile(result.click_ms, 1.0));
}

void print_many(const ConsoleBenchResult& result) {
  for (const auto& [how, square] :
       {std::pair("alone", *result.square), std::pair("every processor busy", *result.busy_square)})
    std::printf(
        "  square, %s: %lld pulses, deviation of the period median %.2f ms, p99 %.2f ms (95 %% interval %.2f "
        "to "
        "%.2f), largest %.2f ms; %.1f images/s a page; real time lost %.2f s%s%s\n",
        how, static_cast<long long>(square.pulses), square.deviation_median_ms, square.deviation_p99_ms,
        square.deviation_p99_interval_ms[0], square.deviation_p99_interval_ms[1], square.deviation_max_ms,
        square.images_per_s, square.lost_real_time_s,
        square.stop_reason.empty() ? "" : "; stopped: ", square.stop_reason.c_str());
}

constexpr MeasuredPart<ConsoleBench, ConsoleBenchResult> kConsoleParts[] = {
    {&ConsoleBench::time_first_image, print_starts},
    {&ConsoleBench::time_one_page, print_one_page},
    {&ConsoleBench::drive_before_many, print_many}};

void bench_console(const CommonOptions& options) {
  auto config = resolve_config<ConsoleBenchConfig>(options);
  nets::use_one_blas_thread();
  choose_segmenter(config.deployment.sensor);
  runs::RunFolder run({options.out, "bench console", common::config_to_json(config), config.deployment.seed});
  ConsoleBench bench(config, options.out, own_path());
  measure(bench, kConsoleParts, run);
}

}  // namespace

void add_bench_console(Verb& bench) {
  Verb& verb =
      bench.add_verb("console",
                     "the operator's page before an emulated bench: images, clicks, the control period; "
                     "exit code 1 when a bound is broken");
  auto& options = configure<ConsoleBenchConfig>(verb, bench_console);
  add_common_options(verb, options);
  add_virtual_rig_options(verb, options);
}

}  // namespace lodestone::apps
