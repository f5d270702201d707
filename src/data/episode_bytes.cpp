#include "lodestone/data/episode_bytes.h"

#include <cstring>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"

namespace lodestone::data {
namespace {

constexpr std::int64_t kUsualPlacements = 1;  // which is not written: nobody counted them at first

template <class Value>
void append(std::string& bytes, const std::vector<Value>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Value));
}

template <class Value>
std::vector<Value> take(std::string_view& bytes, std::size_t count) {
  std::vector<Value> values(count);
  if (count > 0) std::memcpy(values.data(), bytes.data(), count * sizeof(Value));
  bytes.remove_prefix(count * sizeof(Value));
  return values;
}

}  // namespace

std::string to_bytes(const Episode& episode) {
  std::string bytes;
  append(bytes, episode.observations);
  append(bytes, episode.actions);
  append(bytes, episode.terminations);
  append(bytes, episode.truncations);
  append(bytes, episode.zero_current);
  if (episode.placements != kUsualPlacements) append(bytes, std::vector<std::int64_t>{episode.placements});
  return bytes;
}

std::optional<Episode> from_bytes(std::string_view bytes, const RowLayout& layout) {
  const auto s = static_cast<std::size_t>(state_size(layout.state));
  const auto a = static_cast<std::size_t>(layout.action_size);
  const std::size_t first_row = s * sizeof(double);
  const std::size_t step = (s + a) * sizeof(double) + 3;
  const std::size_t steps = bytes.size() < first_row ? 0 : (bytes.size() - first_row) / step;
  const bool counted = bytes.size() == first_row + steps * step + sizeof(std::int64_t);
  if (!counted && bytes.size() != first_row + steps * step) return std::nullopt;
  Episode episode;
  episode.observations = take<double>(bytes, s * (steps + 1));
  episode.actions = take<double>(bytes, a * steps);
  episode.terminations = take<std::uint8_t>(bytes, steps);
  episode.truncations = take<std::uint8_t>(bytes, steps);
  episode.zero_current = take<std::uint8_t>(bytes, steps);
  episode.placements = counted ? take<std::int64_t>(bytes, 1)[0] : kUsualPlacements;
  return episode;
}

std::string checksum(std::string_view bytes) { return common::sha256(bytes).substr(0, kChecksumDigits); }

void compare_checksum(const Episode& episode, std::string_view expected, const std::string& place) {
  if (checksum(to_bytes(episode)) != expected)
    throw common::DataError(
        place + ": its checksum is not that of its numbers: the file is damaged; take it from a backup");
}

}  // namespace lodestone::data
