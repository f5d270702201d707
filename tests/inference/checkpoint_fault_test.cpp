// What happens to a checkpoint when its writer dies or the disk is full. Each fault is brought about in a
// child process.
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <thread>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/inference/checkpoint.h"
#include "temporary_folder.h"

namespace lodestone::inference {
namespace {

constexpr std::int64_t kNumbers = 20000;

Checkpoint numbered(std::int64_t n) {
  Checkpoint checkpoint;
  checkpoint.kind = "numbered";
  checkpoint.facts["n"] = n;
  const Array numbers(std::vector<std::int64_t>(kNumbers, n), {kNumbers});
  checkpoint.parts["a"] = {{"n", numbers}};
  checkpoint.parts["b"] = {{"n", numbers}};
  return checkpoint;
}

/// Loads and proves that every part belongs to the same save; returns its number.
std::int64_t load_number(const std::string& folder) {
  const Checkpoint checkpoint = load_checkpoint(folder, "numbered");
  const auto n = checkpoint.facts.at("n").get<std::int64_t>();
  for (const char* part : {"a", "b"}) {
    REQUIRE(checkpoint.at(part, "n", "test").to_vector<std::int64_t>() ==
            std::vector<std::int64_t>(kNumbers, n));
  }
  return n;
}

[[noreturn]] void save_for_ever(const std::string& folder, std::int64_t n) {
  try {
    for (;; ++n) save_checkpoint(folder, numbered(n));
  } catch (...) {
    _exit(1);
  }
}

TEST_CASE("kill -9 at any moment of a save leaves a whole checkpoint", "[unit]") {
  const tests::TemporaryFolder temporary;
  const std::string folder = temporary / "checkpoint";
  save_checkpoint(folder, numbered(0));
  common::RandomStream random(3, "kill");
  std::int64_t last = 0;
  for (int round = 0; round < 10; ++round) {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) save_for_ever(folder, last + 1);
    std::this_thread::sleep_for(std::chrono::microseconds(static_cast<int>(random.uniform(5e3, 250e3))));
    REQUIRE(kill(child, SIGKILL) == 0);
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    REQUIRE(WIFSIGNALED(status));  // it was still saving
    const std::int64_t now = load_number(folder);
    CHECK(now >= last);
    last = now;
  }
  CHECK(last > 0);
  save_checkpoint(folder, numbered(last + 1));  // what a killed run left behind is in nobody's way
  CHECK(load_number(folder) == last + 1);
}

TEST_CASE("a full disk is an error and leaves the last checkpoint as it was", "[unit]") {
  const tests::TemporaryFolder temporary;
  const std::string folder = temporary / "checkpoint";
  save_checkpoint(folder, numbered(1));
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    // A file-size limit makes write() fail half-way, as a full disk does.
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{kNumbers * 4, kNumbers * 4};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      save_checkpoint(folder, numbered(2));
    } catch (const common::IoError&) {
      _exit(42);
    } catch (...) {
    }
    _exit(1);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 42);
  CHECK(load_number(folder) == 1);
  CHECK_FALSE(std::filesystem::exists(folder + ".staged"));
}

}  // namespace
}  // namespace lodestone::inference
