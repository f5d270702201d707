#include "lodestone/physics/solid_harmonics.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"

using namespace lodestone;
using physics::harmonic_count;
using physics::harmonic_gradients;

namespace {

Eigen::Vector3d draw(common::RandomStream& random) {
  return {random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
}

}  // namespace

TEST_CASE("harmonics of degree 1 are uniform fields, and those of lower degrees come first") {
  CHECK(harmonic_count(1) == 3);
  CHECK(harmonic_count(4) == 24);
  const auto uniform = harmonic_gradients(1, {0.3, -0.2, 0.9});
  CHECK(uniform.isApprox(harmonic_gradients(1, {-0.5, 0.1, 0.0})));
  CHECK(std::abs(uniform.determinant()) > 0.1);
  const Eigen::Vector3d point(0.4, -0.7, 0.2);
  CHECK(harmonic_gradients(5, point).leftCols(harmonic_count(3)).isApprox(harmonic_gradients(3, point)));
  CHECK_THROWS_AS(harmonic_gradients(0, point), common::LogicFault);
}

TEST_CASE("every harmonic's gradient is free of curl and divergence") {
  constexpr int kDegree = 6;
  constexpr double kStep = 1e-5;
  common::RandomStream random(1, "points");
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector3d point = draw(random);
    std::array<physics::HarmonicGradients, 3> slope;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
      slope[static_cast<std::size_t>(axis)] =
          (harmonic_gradients(kDegree, point + step) - harmonic_gradients(kDegree, point - step)) /
          (2.0 * kStep);
    }
    const auto d = [&](std::size_t by, Eigen::Index of) { return slope[by].row(of); };
    CHECK((d(0, 0) + d(1, 1) + d(2, 2)).cwiseAbs().maxCoeff() < 1e-8);
    CHECK((d(0, 1) - d(1, 0)).cwiseAbs().maxCoeff() < 1e-8);
    CHECK((d(1, 2) - d(2, 1)).cwiseAbs().maxCoeff() < 1e-8);
    CHECK((d(2, 0) - d(0, 2)).cwiseAbs().maxCoeff() < 1e-8);
  }
}

TEST_CASE("harmonics are none of them a sum of the others") {
  constexpr int kDegree = 6, kPoints = 60;
  common::RandomStream random(2, "points");
  Eigen::MatrixXd rows(3 * kPoints, harmonic_count(kDegree));
  for (int i = 0; i < kPoints; ++i) rows.middleRows(3 * i, 3) = harmonic_gradients(kDegree, draw(random));
  rows = rows * rows.colwise().norm().cwiseInverse().asDiagonal();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposed(rows);
  decomposed.setThreshold(1e-8);
  CHECK(decomposed.rank() == harmonic_count(kDegree));
}
