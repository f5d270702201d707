#include "lodestone/common/random.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdio>
#include <cstring>

#include "lodestone/common/error.h"

namespace lodestone::common {
namespace {

std::uint64_t split_mix(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

std::uint64_t rotate_left(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }

}  // namespace

std::uint64_t derive_seed(std::uint64_t seed, std::string_view name, std::uint64_t index) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  for (const char c : name) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3ULL;
  }
  std::uint64_t state = seed;
  std::uint64_t mixed = split_mix(state) ^ hash;
  mixed = split_mix(mixed) ^ index;
  return split_mix(mixed);
}

RandomStream::RandomStream(std::uint64_t seed, std::string_view name, std::uint64_t index) {
  std::uint64_t state = derive_seed(seed, name, index);
  for (std::uint64_t& word : state_) word = split_mix(state);
}

std::uint64_t RandomStream::next() {
  const std::uint64_t result = rotate_left(state_[0] + state_[3], 23) + state_[0];
  const std::uint64_t shifted = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= shifted;
  state_[3] = rotate_left(state_[3], 45);
  return result;
}

double RandomStream::uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }

double RandomStream::uniform(double low, double high) { return low + (high - low) * uniform(); }

std::uint64_t RandomStream::below(std::uint64_t n) {
  LODESTONE_CHECK(n > 0, "RandomStream::below needs n > 0");
  std::uint64_t value = next();
  if (value < UINT64_MAX - n)
    return value % n;  // below any tail: spares a division, which takes most of the time
  const std::uint64_t limit =
      n * (UINT64_MAX / n);  // rejects the uneven tail, so every value is equally likely
  while (value >= limit) value = next();
  return value % n;
}

double RandomStream::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  double u = 0.0;
  double v = 0.0;
  double square = 0.0;
  do {
    u = uniform(-1.0, 1.0);
    v = uniform(-1.0, 1.0);
    square = u * u + v * v;
  } while (square >= 1.0 || square == 0.0);
  const double factor = std::sqrt(-2.0 * std::log(square) / square);
  spare_ = v * factor;
  has_spare_ = true;
  return u * factor;
}

std::string RandomStream::save() const {
  std::uint64_t spare_bits = 0;
  std::memcpy(&spare_bits, &spare_, sizeof spare_bits);
  return fmt::format("{:016x} {:016x} {:016x} {:016x} {:016x} {:d}", state_[0], state_[1], state_[2],
                     state_[3], spare_bits, has_spare_);
}

void RandomStream::restore(const std::string& state) {
  unsigned long long words[5] = {};
  int has_spare = 0;
  if (std::sscanf(state.c_str(), "%llx %llx %llx %llx %llx %d", &words[0], &words[1], &words[2], &words[3],
                  &words[4], &has_spare) != 6) {
    throw DataError("random stream state \"" + state + "\" is not five hexadecimal words and a flag");
  }
  for (std::size_t i = 0; i < state_.size(); ++i) state_[i] = words[i];
  const std::uint64_t spare_bits = words[4];
  std::memcpy(&spare_, &spare_bits, sizeof spare_);
  has_spare_ = has_spare != 0;
}

}  // namespace lodestone::common
