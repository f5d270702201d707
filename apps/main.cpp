#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <opencv2/core/utility.hpp>

#include "lodestone/common/blas_kernels.h"
#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "verb.h"

namespace {

constexpr int kUsageError = 2;
constexpr const char* kNoReexec = "--no-reexec";

bool is_given(const char* flag, int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc,
                     [flag](const char* argument) { return std::strcmp(argument, flag) == 0; });
}

/// Names a verb that does not exist, which the parser would only call missing.
void check_verb(const CLI::App& program, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::string known;
  for (const CLI::App* verb : program.get_subcommands([](const CLI::App*) { return true; })) {
    if (verb->get_name() == argv[1]) return;
    known += (known.empty() ? "" : ", ") + verb->get_name();
  }
  throw lodestone::common::ConfigError("unknown verb " + std::string(argv[1]) + "; verbs are " + known);
}

int run(int argc, char** argv) {
  CLI::App program(
      "Lodestone: learns a simulator of a magnetic rig from recorded motion, trains a controller in it,\n"
      "and drives the rig with it. Start with scripts/quickstart, or see `lodestone VERB --help`.");
  program.require_subcommand(1);
  program.fallthrough();  // the flag may stand behind the verb
  program.add_flag(kNoReexec,
                   "keep the matrix kernels OpenBLAS chose, even when they are not for this processor");
  lodestone::apps::ConfigCatalogue catalogue;
  lodestone::apps::add_collect(program, catalogue);
  lodestone::apps::add_import(program, catalogue);
  lodestone::apps::add_train_segmenter(program, catalogue);
  lodestone::apps::add_train_dynamics(program, catalogue);
  lodestone::apps::add_train_policy(program, catalogue);
  lodestone::apps::add_deploy(program, catalogue);
  lodestone::apps::add_evaluate(program, catalogue);
  lodestone::apps::add_calibrate(program, catalogue);
  lodestone::apps::add_rig(program, catalogue);
  lodestone::apps::add_bench(program, catalogue);
  lodestone::apps::add_report(program, catalogue);
  lodestone::apps::add_status(program, catalogue);
  lodestone::apps::add_plan(program, catalogue);
  lodestone::apps::add_config(program, catalogue);
  check_verb(program, argc, argv);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : kUsageError;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (!is_given(kNoReexec, argc, argv)) lodestone::common::restart_with_better_blas_kernels(argv);
  lodestone::common::install_interrupt_handler();
  // Threads are for trials, scenes and shards; an image's own operations are too short to be split.
  cv::setNumThreads(1);
  try {
    return run(argc, argv);
  } catch (const lodestone::common::Error& error) {
    lodestone::common::log_error(error.what());
    return error.exit_code();
  } catch (const std::exception& error) {
    lodestone::common::log_error(std::string("this is a fault in lodestone, please report it: ") +
                                 error.what());
    return 70;
  }
}
