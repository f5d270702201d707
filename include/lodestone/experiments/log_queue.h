#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <thread>

#include "lodestone/common/priority_mutex.h"
#include "lodestone/exports/rig_log.h"

namespace lodestone::experiments {

/// The log of a rig for a control loop that must not wait for a disk: what it is told is written in a thread
/// of its own, in the order in which it was told.
class LogQueue {
 public:
  using Entry = std::function<void(exports::RigLog&)>;
  /// Where entries are written.
  enum class Writes {
    kAtOnce,       ///< by who tells them: the same file in every run
    kInBackground  ///< by a thread
  };

  /// `facts` as RigLog takes them. Throws IoError.
  LogQueue(const std::string& path, const std::map<std::string, std::string>& facts, Writes writes);
  /// Writes what was told and ends the file, in silence where that fails.
  ~LogQueue();
  LogQueue(const LogQueue&) = delete;
  LogQueue& operator=(const LogQueue&) = delete;

  /// Throws IoError with what an entry told before has failed by; nothing is written after that.
  void tell(Entry entry);
  /// Whether so many entries wait that large ones had better be left out.
  bool behind() const;
  /// Everything told is in the file, which has its end. Throws as tell().
  void finish();

 private:
  void run();
  void write(const Entry& entry);
  void check() const;
  void join();

  exports::RigLog log_;
  mutable common::PriorityMutex mutex_;  // of what follows; never held while an entry is written
  std::condition_variable_any told_;
  std::deque<Entry> waiting_;
  std::string fault_;  ///< what writing has failed by
  bool over_ = false;
  bool finished_ = false;
  std::thread thread_;  ///< none where entries are written at once
};

}  // namespace lodestone::experiments
