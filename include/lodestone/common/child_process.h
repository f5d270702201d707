#pragma once

#include <optional>
#include <string>
#include <vector>

namespace lodestone::common {

/// Another program that works beside this one and is listened to. It is interrupted when the thread that
/// started it ends, and so when this program is killed. Move on only after finish().
class ChildProcess {
 public:
  /// Throws IoError where no process can be started.
  explicit ChildProcess(const std::vector<std::string>& words);
  /// Ends it, at once, where it has not ended.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// What it has written to standard output and error since the last call, waited for at most so long; empty
  /// where there was nothing, nothing at all once it writes no more.
  std::optional<std::string> read(double timeout_s);
  /// Asks it to stop, as Ctrl-C does. From any thread, before finish().
  void interrupt() noexcept;
  /// Waits for its end. Its exit code; 128 and more: a signal ended it.
  int finish();

 private:
  int id_ = -1;
  int output_ = -1;
};

}  // namespace lodestone::common
