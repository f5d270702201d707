#pragma once

#include <memory>
#include <string>

namespace lodestone::safety {

/// The ways an operator says stop: Ctrl-C or SIGTERM, a file, and, while keys are watched, any key in the
/// terminal.
class OperatorStop {
 public:
  /// `file`: a run stops as soon as this file exists; empty: no file is looked for. Keys are watched only
  /// when `keys` is set and the program was started in a terminal.
  explicit OperatorStop(std::string file, bool keys = false);
  ~OperatorStop();
  OperatorStop(const OperatorStop&) = delete;
  OperatorStop& operator=(const OperatorStop&) = delete;

  /// Throws Distrust, saying how the operator has said stop.
  void check();

 private:
  struct Terminal;
  std::string file_;
  std::unique_ptr<Terminal> terminal_;
};

}  // namespace lodestone::safety
