#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace lodestone::common {

/// A named stream of random numbers: the same (seed, name, index) always gives the same numbers, and streams
/// of different names or indices are independent. Results therefore do not depend on the number of threads.
/// xoshiro256++ (Blackman and Vigna, 2021), seeded by SplitMix64 over a hash of name and index.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::string_view name, std::uint64_t index = 0);

  std::uint64_t next();
  /// Uniform in [0, 1).
  double uniform();
  double uniform(double low, double high);
  /// Uniform integer in [0, n). n > 0.
  std::uint64_t below(std::uint64_t n);
  /// Standard normal (Marsaglia's polar method; the spare value is part of the state).
  double normal();

  /// The whole state as text, and back; used by checkpoints. restore() throws DataError on malformed text.
  std::string save() const;
  void restore(const std::string& state);

 private:
  std::array<std::uint64_t, 4> state_{};
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// 64-bit seed for a part of a run: streams of two parts share nothing.
std::uint64_t derive_seed(std::uint64_t seed, std::string_view name, std::uint64_t index = 0);

}  // namespace lodestone::common
