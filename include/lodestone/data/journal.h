#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lodestone/data/dataset.h"

namespace lodestone::data {

/// An unfinished recording: one record per episode, appended, each with its size and checksum, after one that
/// says what the numbers mean. A writer that is killed at any point leaves every episode it had finished.

/// What follows the last whole episode of a journal. A writer that is killed leaves part of one; where whole
/// ones come after a damaged one, something else has happened.
enum class AfterDamage {
  kRefuse,  ///< DataError, which says what to do
  kDrop,    ///< the episodes can be made again
};

struct JournalContent {
  DatasetInfo info;
  std::vector<Episode> episodes;
  std::int64_t end_byte = 0;       ///< behind the last whole episode
  std::int64_t dropped_bytes = 0;  ///< behind that
};

/// Throws DataError when it is no journal, or damaged where a killed writer could not have done it.
JournalContent read_journal(const std::string& path, AfterDamage after_damage = AfterDamage::kRefuse);

/// The journal of the dataset `path`: the same name that ends in .journal.
std::string journal_beside(const std::string& path);

/// Appends episodes. One process at a time.
class JournalWriter {
 public:
  /// Makes the journal, or goes on behind its last whole episode; what follows that is dropped. Throws
  /// IoError, and DataError as read_journal and for another state layout.
  JournalWriter(const std::string& path, const DatasetInfo& info, AfterDamage after_damage);
  ~JournalWriter();
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  /// Throws DataError (not a number), and IoError when the disk is full; the episodes before it are kept.
  void write(const Episode& episode);
  /// Everything written has reached the disk, also in a power cut. Throws IoError.
  void sync();
  std::int64_t episodes() const { return episodes_; }
  std::int64_t transitions() const { return transitions_; }

 private:
  [[noreturn]] void fail() const;

  std::string path_;
  DatasetInfo info_;
  int descriptor_ = -1;
  std::int64_t end_byte_ = 0;
  std::int64_t episodes_ = 0;
  std::int64_t transitions_ = 0;
};

}  // namespace lodestone::data
