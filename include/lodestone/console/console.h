#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodestone/console/bench.h"
#include "lodestone/console/jobs.h"
#include "lodestone/task/region.h"

namespace lodestone::console {

/// What the console serves, and where.
struct ConsoleParts {
  Bench::Parts bench;  ///< `tell` is the console's own
  std::vector<JobKind> jobs;
  std::string rig_name;
  std::string rig_kind;                ///< "virtual", "emulated", "serial"
  std::optional<task::Region> region;  ///< where needles were seen to come and go, where that is known
  std::string folder;                  ///< of this session: events.jsonl, recordings
  std::string runs;                    ///< whose runs are listed
  std::string address = "127.0.0.1";
  std::uint16_t port = 8642;  ///< 0: a free one
};

/// The operator's console: one bench, and the page that drives it (docs/console-protocol.md). Lives in
/// threads of its own from the constructor to the destructor, which stops a run.
class Console {
 public:
  /// Throws IoError where the folder cannot be written, HardwareError where the port is taken.
  explicit Console(ConsoleParts parts);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// To be opened in a browser; beyond the loopback with the token that lets it in.
  std::string url() const;
  std::uint16_t port() const;
  BenchState state() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lodestone::console
