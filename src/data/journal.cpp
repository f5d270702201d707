#include "lodestone/data/journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/common/json.h"
#include "lodestone/data/episode_bytes.h"

namespace lodestone::data {
namespace {

using common::DataError;

// A record: mark, size of what it holds (4 bytes, little-endian), its checksum, and what it holds.
constexpr std::string_view kMark = "LSJ1";
constexpr std::size_t kSizeBytes = 4;
constexpr std::size_t kChecksumBytes = 32;
constexpr std::size_t kHead = kMark.size() + kSizeBytes + kChecksumBytes;

std::string make_record(const std::string& held) {
  std::string record(kMark);
  for (std::size_t i = 0; i < kSizeBytes; ++i) record += static_cast<char>(held.size() >> (8 * i) & 0xff);
  return record + checksum(held) + held;
}

/// What the record at a place holds; nothing where there is no whole one.
std::optional<std::string_view> record_at(std::string_view bytes, std::size_t at) {
  if (bytes.size() - at < kHead || bytes.substr(at, kMark.size()) != kMark) return std::nullopt;
  std::size_t size = 0;
  for (std::size_t i = 0; i < kSizeBytes; ++i)
    size |= std::size_t{static_cast<unsigned char>(bytes[at + kMark.size() + i])} << (8 * i);
  if (bytes.size() - at - kHead < size) return std::nullopt;
  const std::string_view held = bytes.substr(at + kHead, size);
  if (bytes.substr(at + kMark.size() + kSizeBytes, kChecksumBytes) != checksum(held)) return std::nullopt;
  return held;
}

bool whole_record_after(std::string_view bytes, std::size_t at) {
  for (std::size_t next = bytes.find(kMark, at + 1); next != std::string_view::npos;
       next = bytes.find(kMark, next + 1))
    if (record_at(bytes, next)) return true;
  return false;
}

DatasetInfo info_of(std::string_view bytes, const std::string& path) {
  const auto held = record_at(bytes, 0);
  if (!held) throw DataError(path + ": not a journal of lodestone, or its beginning is damaged");
  return info_from_json(common::parse_json(*held, path), path);
}

}  // namespace

JournalContent read_journal(const std::string& path, AfterDamage after_damage) {
  const std::string file = common::read_file(path);
  const std::string_view bytes = file;
  JournalContent content;
  content.info = info_of(bytes, path);
  std::size_t at = kHead + record_at(bytes, 0)->size();
  while (const auto held = record_at(bytes, at)) {
    auto episode = from_bytes(*held, content.info.rows());
    if (!episode)
      throw DataError(path + ": episode " + std::to_string(content.episodes.size()) + " holds " +
                      std::to_string(held->size()) + " bytes, which make no episode");
    content.episodes.push_back(std::move(*episode));
    at += kHead + held->size();
  }
  content.end_byte = static_cast<std::int64_t>(at);
  content.dropped_bytes = static_cast<std::int64_t>(bytes.size() - at);
  if (after_damage == AfterDamage::kRefuse && whole_record_after(bytes, at))
    throw DataError(path + ": episode " + std::to_string(content.episodes.size()) + " at byte " +
                    std::to_string(at) +
                    " is damaged, and whole ones follow it; take the file from a backup, or " +
                    "keep the episodes before it: truncate -s " + std::to_string(at) + " " + path);
  return content;
}

std::string journal_beside(const std::string& path) {
  return std::filesystem::path(path).replace_extension(".journal").string();
}

JournalWriter::JournalWriter(const std::string& path, const DatasetInfo& info, AfterDamage after_damage)
    : path_(path), info_(info) {
  if (std::filesystem::exists(path)) {
    const JournalContent content = read_journal(path, after_damage);
    if (content.info.layout != info.layout || content.info.action_size != info.action_size)
      throw DataError(path + ": holds another state layout, or another drive, than the episodes to append");
    end_byte_ = content.end_byte;
    episodes_ = static_cast<std::int64_t>(content.episodes.size());
    for (const Episode& episode : content.episodes) transitions_ += episode.length();
  } else {
    const std::string first = make_record(info_to_json(info).dump());
    common::write_file_atomically(path, first);
    end_byte_ = static_cast<std::int64_t>(first.size());
  }
  descriptor_ = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor_ < 0 || ::ftruncate(descriptor_, end_byte_) != 0) {
    const std::string why = std::strerror(errno);
    if (descriptor_ >= 0) ::close(descriptor_);
    throw common::IoError("cannot write to " + path + ": " + why);
  }
}

JournalWriter::~JournalWriter() { ::close(descriptor_); }

void JournalWriter::fail() const {
  const std::string why = std::strerror(errno);
  // What is left of it would be dropped by the next writer, too.
  const int ignored = ::ftruncate(descriptor_, end_byte_);
  static_cast<void>(ignored);
  throw common::IoError("cannot write episode " + std::to_string(episodes_) + " to " + path_ + ": " + why +
                        "; the episodes before it are kept");
}

void JournalWriter::write(const Episode& episode) {
  check_dataset({info_, {episode}, {}}, path_ + ", episode " + std::to_string(episodes_) + " to be written");
  const std::string record = make_record(to_bytes(episode));
  for (std::size_t written = 0; written < record.size();) {
    const ssize_t n = ::pwrite(descriptor_, record.data() + written, record.size() - written,
                               end_byte_ + static_cast<std::int64_t>(written));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail();
    written += static_cast<std::size_t>(n);
  }
  end_byte_ += static_cast<std::int64_t>(record.size());
  ++episodes_;
  transitions_ += episode.length();
}

void JournalWriter::sync() {
  if (::fdatasync(descriptor_) != 0)
    throw common::IoError("cannot sync " + path_ + ": " + std::strerror(errno) +
                          "; the same command with --resume goes on from the last checkpoint");
}

}  // namespace lodestone::data
