#include "lodestone/exports/policy_header.h"

#include <catch2/catch.hpp>
#include <regex>

#include "exports/policies.h"
#include "lodestone/common/files.h"
#include "lodestone/common/shell.h"
#include "temporary_folder.h"

using namespace lodestone;
using exports::PolicyContract;

namespace {

/// Compiles a header alone, as a program that tests itself, and runs it.
common::CommandResult self_test(const tests::TemporaryFolder& folder, const std::string& header) {
  common::write_file_atomically(folder / "policy.h", header);
  const std::vector<std::string> strictly = {"gcc",     "-std=c99",  "-Wall", "-Wextra",
                                             "-Werror", "-pedantic", "-O1"};
  std::vector<std::string> alone = strictly;
  alone.insert(alone.end(), {"-x", "c", "-fsyntax-only", folder / "policy.h"});
  common::CommandResult run = common::run_command(alone);
  if (run.exit_code != 0) return run;
  std::vector<std::string> program = strictly;
  program.insert(program.end(),
                 {"-DLODESTONE_POLICY_TEST", "-x", "c", folder / "policy.h", "-o", folder / "test", "-lm"});
  run = common::run_command(program);
  return run.exit_code != 0 ? run : common::run_command({folder / "test"});
}

/// What the header allows itself, in units of the largest current.
double rounding(const std::string& header, double scale_A) {
  std::smatch found;
  REQUIRE(std::regex_search(header, found, std::regex("LODESTONE_ROUNDING_A (\\S+)f\n")));
  return std::stod(found[1]) / scale_A;
}

}  // namespace

TEST_CASE("released policies as headers in C repeat our decisions", "[unit]") {
  for (const std::string& folder : tests::released_policies()) {
    CAPTURE(folder);
    const tests::TemporaryFolder scratch;
    const std::string header = policy_header(PolicyContract(inference::load_policy(folder)));
    const common::CommandResult run = self_test(scratch, header);
    INFO(run.output);
    CHECK(run.exit_code == 0);
    WARN(folder << ": " << run.output);
    CHECK(rounding(header, 15.0) < 2e-3);
  }
}

TEST_CASE("every kind of policy as a header in C repeats our decisions", "[unit]") {
  for (const inference::Policy& policy : tests::policies_of_every_kind()) {
    CAPTURE(task::encoder_to_json(policy.encoder).dump());
    const tests::TemporaryFolder scratch;
    const PolicyContract contract(policy);
    const std::string header = policy_header(contract);
    const common::CommandResult run = self_test(scratch, header);
    INFO(run.output);
    CHECK(run.exit_code == 0);
    CHECK(rounding(header, contract.scale_A()) < 2e-3);
  }
}

TEST_CASE("a header in C that decides otherwise says so", "[unit]") {
  std::string header = policy_header(PolicyContract(tests::untrained_policy({})));
  const std::size_t bias = header.find("lodestone_l2_bias[12]");
  REQUIRE(bias != std::string::npos);
  header.insert(header.find('{', bias) + 1, "4.0f+");
  const tests::TemporaryFolder scratch;
  const common::CommandResult run = self_test(scratch, header);
  CHECK(run.exit_code == 1);
  CHECK_THAT(run.output, Catch::StartsWith("currents differ from Lodestone's by"));
}

TEST_CASE("what is not a number gives no current and is not remembered", "[unit]") {
  const tests::TemporaryFolder scratch;
  task::EncoderConfig encoder;
  encoder.memory = true;
  common::write_file_atomically(scratch / "policy.h",
                                policy_header(PolicyContract(tests::untrained_policy(encoder))));
  common::write_file_atomically(scratch / "main.c", R"C(
#include "policy.h"
int main(void)
{
  lodestone_policy_memory memory = {0};
  lodestone_policy_input in = {0};
  float current_A[4], sum_A[2] = {0.0f, 0.0f};
  int coil, time;
  for (time = 0; time < 2; ++time) {
    in.x_m = time == 0 ? NAN : 0.01f;
    lodestone_policy_decide(&in, &memory, current_A);
    for (coil = 0; coil < 4; ++coil) sum_A[time] += current_A[coil];
    if (memory.known != (time == 0 ? 0.0f : 1.0f)) return 2;
  }
  return sum_A[0] == 0.0f && sum_A[1] > 0.0f ? 0 : 1;
}
)C");
  const common::CommandResult built =
      common::run_command({"gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", scratch / "main.c",
                           "-o", scratch / "main", "-lm"});
  INFO(built.output);
  REQUIRE(built.exit_code == 0);
  CHECK(common::run_command({scratch / "main"}).exit_code == 0);
}

TEST_CASE("no array of a header in C is larger than AVR allows", "[unit]") {
  const std::string header =
      policy_header(PolicyContract(inference::load_policy(LODESTONE_SOURCE_DIR "/models/any_rig")));
  const std::regex array("static const (int16_t|float) \\w+\\[(\\d+)\\] LODESTONE_PROGRAM");
  int arrays = 0;
  std::int64_t bytes = 0;
  for (std::sregex_iterator found(header.begin(), header.end(), array), none; found != none;
       ++found, ++arrays) {
    const std::int64_t size = std::stol((*found)[2]) * ((*found)[1] == "float" ? 4 : 2);
    CHECK(size <= 32'767);
    bytes += size;
  }
  CHECK(arrays > 10);
  CHECK(bytes > 2 * 256 * 256);
  CHECK(bytes < 200'000);
}

TEST_CASE("a header in C says what it uses, of what rig it is, and when it is too large for an ATmega",
          "[unit]") {
  const std::string small =
      policy_header(PolicyContract(inference::load_policy(LODESTONE_SOURCE_DIR "/models/target")));
  const std::string comment = small.substr(0, small.find("*/"));
  for (const char* text :
       {"- target: where the target is", "\"max_current_A\":15.0", "Task: {\"goal\":\"point\"}"})
    CHECK(std::regex_replace(comment, std::regex("\n \\* "), "").find(text) != std::string::npos);
  CHECK(comment.find("too large for an ATmega2560") == std::string::npos);
  const std::string large = policy_header(PolicyContract(tests::untrained_policy({}, 0, {400, 400})));
  CHECK(large.find("too large for an ATmega2560") != std::string::npos);
}
