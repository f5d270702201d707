#include "lodestone/common/blas_kernels.h"

#include <catch2/catch.hpp>

using lodestone::common::better_blas_core;
using lodestone::common::slow_blas_note;
using lodestone::common::VectorUnits;

namespace {

constexpr VectorUnits kSse{false, false};
constexpr VectorUnits kAvx2{true, false};
constexpr VectorUnits kAvx512{true, true};

/// Every name that openblas_get_corename() can give on x86-64, and what stands in its place.
struct Core {
  const char* name;
  const char* on_avx2;
  const char* on_avx512;
};
constexpr Core kCores[] = {
    {"Unknown", "HASWELL", "SKYLAKEX"},
    {"Katmai", "HASWELL", "SKYLAKEX"},
    {"Coppermine", "HASWELL", "SKYLAKEX"},
    {"Northwood", "HASWELL", "SKYLAKEX"},
    {"Prescott", "HASWELL", "SKYLAKEX"},
    {"Banias", "HASWELL", "SKYLAKEX"},
    {"Atom", "HASWELL", "SKYLAKEX"},
    {"Core2", "HASWELL", "SKYLAKEX"},
    {"Penryn", "HASWELL", "SKYLAKEX"},
    {"Dunnington", "HASWELL", "SKYLAKEX"},
    {"Nehalem", "HASWELL", "SKYLAKEX"},
    {"Athlon", "HASWELL", "SKYLAKEX"},
    {"Opteron", "HASWELL", "SKYLAKEX"},
    {"Opteron_SSE3", "HASWELL", "SKYLAKEX"},
    {"Barcelona", "HASWELL", "SKYLAKEX"},
    {"Nano", "HASWELL", "SKYLAKEX"},
    {"Sandybridge", "HASWELL", "SKYLAKEX"},
    {"Bobcat", "HASWELL", "SKYLAKEX"},
    {"Bulldozer", "HASWELL", "SKYLAKEX"},
    {"Piledriver", "HASWELL", "SKYLAKEX"},
    {"Steamroller", "HASWELL", "SKYLAKEX"},
    {"Excavator", "HASWELL", "SKYLAKEX"},
    {"Haswell", "", "SKYLAKEX"},
    {"Zen", "", "SKYLAKEX"},
    {"SkylakeX", "", ""},
    {"Cooperlake", "", ""},
    {"SapphireRapids", "", ""},
};

}  // namespace

TEST_CASE("whatever kernels OpenBLAS chose below what the processor can do are replaced", "[common]") {
  for (const Core& core : kCores) {
    CAPTURE(core.name);
    CHECK(better_blas_core(core.name, kAvx512, "") == core.on_avx512);
    CHECK(better_blas_core(core.name, kAvx2, "") == core.on_avx2);
    CHECK(better_blas_core(core.name, kSse, "").empty());
    CHECK(better_blas_core(core.name, kAvx512, "HASWELL").empty());  // the user's choice stands
  }
  CHECK(better_blas_core("unknown", kAvx512, "").empty());  // not OpenBLAS
}

TEST_CASE("a BLAS below half of our own product's pace is named, with what it cannot do", "[common]") {
  CHECK(slow_blas_note("Haswell", 105e9, 172e9).empty());
  CHECK(slow_blas_note("Haswell", 87e9, 172e9).empty());
  const std::string note = slow_blas_note("Prescott", 21e9, 172e9);
  CHECK_THAT(note, Catch::Matchers::Contains("Prescott") && Catch::Matchers::Contains("12 %") &&
                       Catch::Matchers::Contains("OPENBLAS_CORETYPE"));
}
