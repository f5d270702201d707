#include "lodestone/common/random.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "lodestone/common/error.h"

using namespace lodestone::common;

TEST_CASE("a stream is decided by seed, name and index") {
  CHECK(RandomStream(1, "noise", 2).next() == RandomStream(1, "noise", 2).next());
  std::set<std::uint64_t> first;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    for (const char* name : {"noise", "reset", ""}) {
      for (std::uint64_t index = 0; index < 10; ++index) first.insert(RandomStream(seed, name, index).next());
    }
  }
  CHECK(first.size() == 300);
}

TEST_CASE("uniform and normal numbers have their moments") {
  RandomStream random(7, "moments");
  double sum = 0.0;
  double square = 0.0;
  double uniform = 0.0;
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double x = random.normal();
    sum += x;
    square += x * x;
    const double u = random.uniform();
    REQUIRE((u >= 0.0 && u < 1.0));
    uniform += u;
  }
  CHECK(std::abs(sum / n) < 0.01);
  CHECK(std::abs(square / n - 1.0) < 0.02);
  CHECK(std::abs(uniform / n - 0.5) < 0.005);
}

TEST_CASE("below(n) reaches every value evenly") {
  RandomStream random(3, "below");
  int counts[5] = {};
  for (int i = 0; i < 50000; ++i) ++counts[random.below(5)];
  for (const int count : counts) CHECK(std::abs(count - 10000) < 400);
}

TEST_CASE("below(n) leaves out the uneven tail of the largest numbers") {
  // Values of next() below n * floor((2^64 - 1) / n) count, modulo n: by hand, beside what draws them.
  for (const std::uint64_t n : {std::uint64_t{3}, std::uint64_t{1} << 63, (std::uint64_t{1} << 63) + 12345,
                                UINT64_MAX / 3 * 2, UINT64_MAX}) {
    RandomStream drawn(4, "tail"), raw(4, "tail");
    for (int i = 0; i < 200; ++i) {
      std::uint64_t value = raw.next();
      while (value >= n * (UINT64_MAX / n)) value = raw.next();
      CHECK(drawn.below(n) == value % n);
    }
  }
}

TEST_CASE("a restored stream goes on as the saved one, spare normal included") {
  RandomStream random(5, "state");
  random.normal();
  RandomStream other(6, "other");
  other.restore(random.save());
  for (int i = 0; i < 10; ++i) CHECK(other.normal() == random.normal());
  CHECK_THROWS_AS(other.restore("nonsense"), DataError);
}
