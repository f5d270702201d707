#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <string>

#include "lodestone/common/blas_kernels.h"
#include "lodestone/common/build_facts.h"
#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"
#include "lodestone/common/log.h"
#include "next_step.h"
#include "parser.h"
#include "verbs.h"

namespace {

using namespace lodestone;

constexpr const char* kNoReexec = "--no-reexec";

bool is_given(const char* flag, int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc,
                     [flag](const char* argument) { return std::strcmp(argument, flag) == 0; });
}

std::string version() {
  const common::Json facts = common::build_and_host_facts();
  const auto text = [&facts](const char* key) { return facts[key].get<std::string>(); };
  return "lodestone " + text("lodestone") + " (commit " + text("git_commit") + ", " + text("build_type") +
         ")";
}

/// What was printed must have arrived: that a disk is full shows only when it is handed over.
void check_output() {
  std::cout.flush();
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !std::cout.good())
    throw common::IoError("the results could not be written to standard output: check where it goes to");
}

/// A page that this call did not write: it only listed cells, or ran one of them.
bool opens_nothing(const std::string& step) {
  const std::string open = "open ";
  return step.rfind(open, 0) == 0 &&
         !std::filesystem::exists(step.substr(open.size(), step.find(" in a browser") - open.size()));
}

int run(int argc, char** argv) {
  apps::Verb program{
      "lodestone",
      "Lodestone: learns a simulator of a magnetic rig from recorded motion, trains a controller in it,\n"
      "and drives the rig with it. Start with scripts/quickstart, or see `lodestone VERB --help`."};
  bool no_reexec = false;  // looked at in main, before anything else
  program.add_option(kNoReexec, &no_reexec,
                     "keep the matrix kernels OpenBLAS chose, even when they are not for this processor");
  program.add_option("--version", apps::Text{version}, "Display program version information and exit");
  apps::add_verbs(program);
  apps::add_completion(program);
  const apps::Parsed parsed = apps::parse(program, argc, argv);
  if (parsed.verb != nullptr) parsed.verb->run();
  check_output();
  if (parsed.verb == nullptr) return parsed.exit_code;
  std::map<std::string, std::string> given = parsed.given;
  if (parsed.verb->configuration)
    for (const common::ConfigRow& row : parsed.verb->configuration())
      given[row.key] = row.value.is_string() ? row.value.get<std::string>() : row.value.dump();
  const std::string step = apps::next_step(parsed.path, given);
  // On standard error: results go to standard output.
  if (!step.empty() && !opens_nothing(step)) std::fprintf(stderr, "next: %s\n", step.c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (!is_given(kNoReexec, argc, argv)) common::restart_with_better_blas_kernels(argv);
  common::install_interrupt_handler();
  // Threads are for trials, scenes and shards; an image's own operations are too short to be split.
  cv::setNumThreads(1);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // faults are told once, by us
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
