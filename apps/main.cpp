#include <cstdio>
#include <exception>

#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "verb.h"

namespace {

constexpr int kUsageError = 2;

int run(int argc, char** argv) {
  CLI::App program(
      "Lodestone: learns a simulator of a magnetic rig from recorded motion, trains a controller in it, and "
      "drives\n"
      "the rig with it. Start with scripts/quickstart, or see `lodestone VERB --help`.");
  program.require_subcommand(1);
  lodestone::apps::ConfigCatalogue catalogue;
  lodestone::apps::add_collect(program, catalogue);
  lodestone::apps::add_import(program, catalogue);
  lodestone::apps::add_train_dynamics(program, catalogue);
  lodestone::apps::add_train_policy(program, catalogue);
  lodestone::apps::add_deploy(program, catalogue);
  lodestone::apps::add_evaluate(program, catalogue);
  lodestone::apps::add_rig(program, catalogue);
  lodestone::apps::add_bench(program, catalogue);
  lodestone::apps::add_report(program, catalogue);
  lodestone::apps::add_config(program, catalogue);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : kUsageError;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  lodestone::common::install_interrupt_handler();
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
