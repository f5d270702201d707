#pragma once

#include <stdexcept>
#include <string>

namespace lodestone::common {

/// Base of every fault a user or a device can cause. The message is one line: what is wrong, where,
/// which bound it broke and what to do. `main` prints it and exits with exit_code().
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, int exit_code = 1)
      : std::runtime_error(message), exit_code_(exit_code) {}
  int exit_code() const noexcept { return exit_code_; }

 private:
  int exit_code_;
};

/// A configuration or command line that cannot be used (exit code 2; nothing has been written).
class ConfigError : public Error {
 public:
  explicit ConfigError(const std::string& message) : Error(message, 2) {}
};

/// A data file that cannot be read, or holds values that cannot be used.
class DataError : public Error {
 public:
  using Error::Error;
};

/// A checkpoint that is truncated, altered, of another kind or of another version.
class CheckpointError : public Error {
 public:
  using Error::Error;
};

/// A file or folder that cannot be read or written.
class IoError : public Error {
 public:
  using Error::Error;
};

/// A device that does not answer, or answers with a fault.
class HardwareError : public Error {
 public:
  using Error::Error;
};

/// The user asked to stop (Ctrl-C); what was done so far is saved.
class Interrupted : public Error {
 public:
  explicit Interrupted(const std::string& message) : Error(message, 130) {}
};

/// A broken invariant: a mistake in the program or in how the library is called.
class LogicFault : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

[[noreturn]] void throw_check_failure(const char* condition, const char* file, int line,
                                      const std::string& message);

}  // namespace lodestone::common

/// Throws LogicFault unless `condition` holds; `message` says what was expected, with the value.
#define LODESTONE_CHECK(condition, message)                                                                \
  do {                                                                                                     \
    if (!(condition)) ::lodestone::common::throw_check_failure(#condition, __FILE__, __LINE__, (message)); \
  } while (false)
