#pragma once
// A long check: scripts/test takes a seeded sample of it, scripts/soak (LODESTONE_SOAK=1) the whole.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

namespace lodestone::tests {

/// Counts what a long check goes through, and says so at its end in the line that scripts/soak collects:
/// `soak: COUNT WHAT, seed SEED`. Tag such a case [soak].
class Soak {
 public:
  /// `what`: things counted, in the plural. `sample` of them in scripts/test, `whole` of them in
  /// scripts/soak.
  Soak(std::string what, std::int64_t sample, std::int64_t whole)
      : what_(std::move(what)), count_(std::getenv("LODESTONE_SOAK") == nullptr ? sample : whole) {
    const char* seed = std::getenv("LODESTONE_SOAK_SEED");
    if (seed != nullptr) seed_ = std::strtoull(seed, nullptr, 10);
  }
  ~Soak() {
    std::printf("soak: %lld %s, seed %llu\n", static_cast<long long>(count_), what_.c_str(),
                static_cast<unsigned long long>(seed_));
  }
  Soak(const Soak&) = delete;
  Soak& operator=(const Soak&) = delete;

  std::int64_t count() const { return count_; }
  std::uint64_t seed() const { return seed_; }

 private:
  std::string what_;
  std::int64_t count_;
  std::uint64_t seed_ = 1;  ///< LODESTONE_SOAK_SEED
};

}  // namespace lodestone::tests
