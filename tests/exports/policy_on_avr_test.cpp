// An exported policy on an emulated ATmega2560, cycle by cycle.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdarg>
#include <cstring>

extern "C" {
#include <simavr/sim_avr.h>
#include <simavr/sim_io.h>
}

#include "exports/policies.h"
#include "lodestone/common/files.h"
#include "lodestone/common/shell.h"
#include "lodestone/exports/policy_header.h"
#include "temporary_folder.h"

using namespace lodestone;
using exports::PolicyContract;

namespace {

constexpr double kAvrFrequency_Hz = 16e6;
constexpr double kControlPeriod_s = 0.3;
constexpr std::size_t kFlashBytes = 256 * 1024;
constexpr avr_io_addr_t kMarks = 0x3e, kNumbers = 0x4a;  // GPIOR0, GPIOR1

/// What avr_policy.c does, and when.
struct AvrRun {
  std::vector<std::array<float, 4>> current_A;
  avr_cycle_count_t began = 0, longest = 0;
  std::string bytes;  // of a decision
  bool over = false;
};

void on_mark(avr_t* avr, avr_io_addr_t, std::uint8_t mark, void* param) {
  AvrRun& run = *static_cast<AvrRun*>(param);
  if (mark == 1) run.began = avr->cycle;
  if (mark == 2) run.longest = std::max(run.longest, avr->cycle - run.began);
  run.over = mark == 3;
}

void on_number(avr_t*, avr_io_addr_t, std::uint8_t byte, void* param) {
  AvrRun& run = *static_cast<AvrRun*>(param);
  run.bytes += static_cast<char>(byte);
  if (run.bytes.size() < sizeof(run.current_A.front())) return;
  run.current_A.emplace_back();
  std::memcpy(run.current_A.back().data(), run.bytes.data(), run.bytes.size());
  run.bytes.clear();
}

/// The program's image, as a programmer would flash it.
std::string image_of(const PolicyContract& contract) {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "policy.h", policy_header(contract));
  const auto run = [](const std::vector<std::string>& words) {
    const common::CommandResult result = common::run_command(words);
    INFO(result.output);
    REQUIRE(result.exit_code == 0);
  };
  run({"avr-gcc", "-mmcu=atmega2560", "-O2", "-std=c99", "-Wall", "-Wextra", "-Werror", "-I", folder.path(),
       LODESTONE_SOURCE_DIR "/tests/exports/avr_policy.c", "-o", folder / "policy.elf", "-lm"});
  run({"avr-objcopy", "-O", "binary", "-R", ".eeprom", folder / "policy.elf", folder / "policy.bin"});
  return common::read_file(folder / "policy.bin");
}

AvrRun run_on_avr(std::string image) {
  avr_global_logger_set([](avr_t*, const int, const char*, va_list) {});
  avr_t* const avr = avr_make_mcu_by_name("atmega2560");
  REQUIRE(avr != nullptr);
  avr_init(avr);
  avr->frequency = static_cast<std::uint32_t>(kAvrFrequency_Hz);
  avr_loadcode(avr, reinterpret_cast<std::uint8_t*>(image.data()), static_cast<std::uint32_t>(image.size()),
               0);
  avr->codeend = static_cast<avr_flashaddr_t>(image.size());
  AvrRun run;
  avr_register_io_write(avr, kMarks, on_mark, &run);
  avr_register_io_write(avr, kNumbers, on_number, &run);
  int state = cpu_Running;
  while (!run.over && state != cpu_Crashed && state != cpu_Done) state = avr_run(avr);
  avr_terminate(avr);
  return run;
}

}  // namespace

TEST_CASE("a policy decides on an ATmega2560 within one control period, as it does here", "[unit]") {
  for (const char* name : {"centre", "target", "any_rig"}) {
    CAPTURE(name);
    const PolicyContract contract(
        inference::load_policy(std::string(LODESTONE_SOURCE_DIR "/models/") + name));
    const std::string image = image_of(contract);
    CHECK(image.size() < kFlashBytes);
    const AvrRun run = run_on_avr(image);
    const exports::GoldenEpisode golden = golden_episodes(contract).front();
    REQUIRE(run.current_A.size() == golden.size());
    double worst_A = 0.0;
    for (std::size_t step = 0; step < golden.size(); ++step)
      for (std::size_t coil = 0; coil < 4; ++coil)
        worst_A =
            std::max<double>(worst_A, std::abs(run.current_A[step][coil] - golden[step].current_A[coil]));
    const double seconds = static_cast<double>(run.longest) / kAvrFrequency_Hz;
    WARN(name << ": " << image.size() << " bytes of flash, " << run.longest << " cycles a decision at most ("
              << 1e3 * seconds << " ms at 16 MHz), currents differ by " << worst_A << " A at most");
    CHECK(seconds > 0.01);
    CHECK(seconds < kControlPeriod_s);
    CHECK(worst_A < 2e-3 * contract.scale_A());
  }
}
