#include "episode_batch.h"

#include "lodestone/common/error.h"
#include "lodestone/data/episode_bytes.h"

namespace lodestone::data {
namespace {

/// All episodes, one behind the other.
struct Batch {
  std::vector<std::int64_t> steps;
  std::vector<std::int64_t> placements;
  std::vector<std::uint8_t> checksums;  // hex digits
  Episode joined;                       // of each episode one observation more than actions
};

template <class Values>
void append_values(Values& all, const Values& values) {
  all.insert(all.end(), values.begin(), values.end());
}

Batch join(const std::vector<Episode>& episodes) {
  Batch batch;
  for (const Episode& episode : episodes) {
    const std::string digits = checksum(to_bytes(episode));
    batch.steps.push_back(episode.length());
    batch.placements.push_back(episode.placements);
    batch.checksums.insert(batch.checksums.end(), digits.begin(), digits.end());
    append_values(batch.joined.observations, episode.observations);
    append_values(batch.joined.actions, episode.actions);
    append_values(batch.joined.terminations, episode.terminations);
    append_values(batch.joined.truncations, episode.truncations);
    append_values(batch.joined.zero_current, episode.zero_current);
  }
  return batch;
}

/// Takes the next values of a batch.
template <class Value>
class Taker {
 public:
  explicit Taker(const std::vector<Value>& values) : next_(values.begin()) {}
  std::vector<Value> take(std::size_t count) {
    const auto first = next_;
    next_ += static_cast<std::ptrdiff_t>(count);
    return {first, next_};
  }

 private:
  typename std::vector<Value>::const_iterator next_;
};

/// Throws DataError where `steps` do not add up to what the arrays hold.
void check_steps(const Batch& batch, std::size_t state_size, std::size_t action_size,
                 const std::string& place) {
  const std::size_t held = batch.joined.terminations.size();
  std::size_t sum = 0;
  for (const std::int64_t steps : batch.steps) {
    if (steps < 0 || static_cast<std::size_t>(steps) > held - sum)
      throw common::DataError(place + ": an episode of " + std::to_string(steps) + " steps, of " +
                              std::to_string(held) + " in the file: it is damaged");
    sum += static_cast<std::size_t>(steps);
  }
  const Episode& all = batch.joined;
  if (sum != held || all.observations.size() != (held + batch.steps.size()) * state_size ||
      all.actions.size() != held * action_size || all.truncations.size() != held ||
      all.zero_current.size() != held || batch.placements.size() != batch.steps.size() ||
      batch.checksums.size() != batch.steps.size() * kChecksumDigits)
    throw common::DataError(place + ": " + std::to_string(batch.steps.size()) + " episodes of together " +
                            std::to_string(sum) + " steps do not fit its arrays: the file is damaged");
}

}  // namespace

bool write_episode_batch(hid_t group, const std::vector<Episode>& episodes, const RowLayout& layout) {
  const Batch batch = join(episodes);
  const Episode& all = batch.joined;
  const auto e = static_cast<hsize_t>(episodes.size());
  const auto n = static_cast<hsize_t>(all.length());
  const auto s = static_cast<hsize_t>(state_size(layout.state));
  const auto a = static_cast<hsize_t>(layout.action_size);
  const auto whole = [&](const char* name, const std::vector<std::int64_t>& values) {
    return write_array(group, name, H5T_STD_I64LE, H5T_NATIVE_INT64, values.data(), {e});
  };
  const auto numbers = [&](const char* name, const std::vector<double>& values, std::vector<hsize_t> shape) {
    return write_array(group, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(), shape);
  };
  const auto bytes = [&](const char* name, const std::vector<std::uint8_t>& values,
                         std::vector<hsize_t> shape) {
    return write_array(group, name, H5T_STD_U8LE, H5T_NATIVE_UINT8, values.data(), shape);
  };
  return whole("steps", batch.steps) && whole("placements", batch.placements) &&
         bytes("checksums", batch.checksums, {e, kChecksumDigits}) &&
         numbers("observations", all.observations, {n + e, s}) && numbers("actions", all.actions, {n, a}) &&
         bytes("terminations", all.terminations, {n}) && bytes("truncations", all.truncations, {n}) &&
         bytes("zero_current", all.zero_current, {n});
}

std::vector<Episode> read_episode_batch(hid_t group, const RowLayout& layout, ArrayReader& reader,
                                        const std::string& place) {
  const auto s = static_cast<std::size_t>(state_size(layout.state));
  const auto a = static_cast<std::size_t>(layout.action_size);
  Batch batch;
  Episode& all = batch.joined;
  reader.read(group, "steps", 1, batch.steps, place);
  reader.read(group, "placements", 1, batch.placements, place);
  reader.read(group, "checksums", kChecksumDigits, batch.checksums, place);
  reader.read(group, "observations", s, all.observations, place);
  reader.read(group, "actions", a, all.actions, place);
  reader.read(group, "terminations", 1, all.terminations, place);
  reader.read(group, "truncations", 1, all.truncations, place);
  reader.read(group, "zero_current", 1, all.zero_current, place);
  check_steps(batch, s, a, place);

  Taker observations(all.observations);
  Taker actions(all.actions);
  Taker terminations(all.terminations);
  Taker truncations(all.truncations);
  Taker zero_current(all.zero_current);
  Taker checksums(batch.checksums);
  std::vector<Episode> episodes(batch.steps.size());
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    const auto steps = static_cast<std::size_t>(batch.steps[e]);
    episodes[e].observations = observations.take((steps + 1) * s);
    episodes[e].actions = actions.take(steps * a);
    episodes[e].terminations = terminations.take(steps);
    episodes[e].truncations = truncations.take(steps);
    episodes[e].zero_current = zero_current.take(steps);
    episodes[e].placements = batch.placements[e];
    const std::vector<std::uint8_t> digits = checksums.take(kChecksumDigits);
    compare_checksum(episodes[e], std::string(digits.begin(), digits.end()),
                     place + ": episode " + std::to_string(e));
  }
  return episodes;
}

}  // namespace lodestone::data
