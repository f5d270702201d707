#pragma once

namespace lodestone::imaging {

/// While it lives, standard error goes nowhere: image libraries print lines of their own on it before they
/// say that something failed, and we say it once, with the file's name.
class QuietStderr {
 public:
  QuietStderr();
  ~QuietStderr();
  QuietStderr(const QuietStderr&) = delete;
  QuietStderr& operator=(const QuietStderr&) = delete;

 private:
  int kept_;  ///< what standard error is; -1: it could not be kept, and stays
};

}  // namespace lodestone::imaging
