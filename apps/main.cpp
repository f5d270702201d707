#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <opencv2/core/utility.hpp>

#include "completion.h"
#include "lodestone/common/blas_kernels.h"
#include "lodestone/common/build_facts.h"
#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "lodestone/common/spelling.h"
#include "next_step.h"
#include "verb.h"

namespace {

using namespace lodestone;

constexpr int kUsageError = 2;
constexpr const char* kNoReexec = "--no-reexec";

bool is_given(const char* flag, int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc,
                     [flag](const char* argument) { return std::strcmp(argument, flag) == 0; });
}

/// Names a verb that does not exist, which the parser would only call unexpected or missing.
void check_verb(const CLI::App& program, int argc, char** argv) {
  const CLI::App* at = &program;
  for (int i = 1; i < argc && argv[i][0] != '-'; ++i) {
    const CLI::App* found = nullptr;
    std::vector<std::string> known;
    for (const CLI::App* verb : at->get_subcommands([](const CLI::App*) { return true; })) {
      known.push_back(verb->get_name());
      if (verb->get_name() == argv[i]) found = verb;
    }
    if (known.empty()) return;
    const std::string path = at == &program ? "" : at->get_name() + " ";
    if (found == nullptr)
      throw common::ConfigError("unknown verb " + path + argv[i] + "; " +
                                common::spelling_hint(argv[i], known, "verbs", path));
    at = found;
  }
}

std::string version() {
  const common::Json facts = common::build_and_host_facts();
  const auto text = [&facts](const char* key) { return facts[key].get<std::string>(); };
  return "lodestone " + text("lodestone") + " (commit " + text("git_commit") + ", " + text("build_type") +
         ")";
}

/// On standard error: results go to standard output.
void print_next_step(const CLI::App& program) {
  const CLI::App* verb = &program;
  std::string path;
  while (!verb->get_subcommands().empty()) {
    verb = verb->get_subcommands().front();
    path += (path.empty() ? "" : " ") + verb->get_name();
  }
  const std::string step = apps::next_step(path, [verb](const std::string& name) {
    const CLI::Option* option = verb->get_option_no_throw(name);
    return option == nullptr || option->results().empty() ? std::string() : option->results().front();
  });
  if (!step.empty()) std::fprintf(stderr, "next: %s\n", step.c_str());
}

int run(int argc, char** argv) {
  CLI::App program(
      "Lodestone: learns a simulator of a magnetic rig from recorded motion, trains a controller in it,\n"
      "and drives the rig with it. Start with scripts/quickstart, or see `lodestone VERB --help`.");
  program.require_subcommand(1);
  program.fallthrough();  // the flag may stand behind the verb
  program.add_flag(kNoReexec,
                   "keep the matrix kernels OpenBLAS chose, even when they are not for this processor");
  apps::ConfigCatalogue catalogue;
  apps::add_verbs(program, catalogue);
  apps::add_completion(program, catalogue);
  program.set_version_flag("--version", version);
  check_verb(program, argc, argv);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : kUsageError;
  }
  print_next_step(program);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (!is_given(kNoReexec, argc, argv)) common::restart_with_better_blas_kernels(argv);
  common::install_interrupt_handler();
  // Threads are for trials, scenes and shards; an image's own operations are too short to be split.
  cv::setNumThreads(1);
  try {
    return run(argc, argv);
  } catch (const common::Error& error) {
    common::log_error(error.what());
    return error.exit_code();
  } catch (const std::exception& error) {
    common::log_error(std::string("this is a fault in lodestone, please report it: ") + error.what());
    return 70;
  }
}
