#pragma once

#include <cstdint>
#include <string>

namespace lodestone::common {

/// Progress of a long step on standard error: a bar with time left on a terminal, a plain line at most every
/// ten seconds otherwise. finish() (or the destructor) ends the line.
class Progress {
 public:
  Progress(std::string label, std::int64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of `total` units are finished; `note` is a short text such as "loss 0.031".
  void update(std::int64_t done, const std::string& note = "");
  void finish(const std::string& note = "");

 private:
  void draw(const std::string& note, bool last);

  std::string label_;
  std::int64_t total_;
  std::int64_t done_ = 0;
  std::int64_t first_ = -1;
  double start_s_;
  double drawn_s_ = -1e9;
  bool terminal_;
  bool finished_ = false;
};

}  // namespace lodestone::common
