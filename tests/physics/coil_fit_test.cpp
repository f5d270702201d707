#include "lodestone/physics/coil_fit.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/physics/standing_coil.h"
#include "measured_rig.h"

namespace lodestone::physics {
namespace {

/// What a magnetometer of so much noise sees of coils, all of them on, in 20 mm around the dish centre.
FieldSamples samples_of(const CoilsDescription& coils, std::size_t count, double noise_T) {
  common::RandomStream random(3, "samples of coils");
  FieldSamples samples;
  samples.coils = coils.count();
  std::vector<StandingCoil> exact;
  for (std::size_t coil = 0; coil < coils.count(); ++coil) exact.emplace_back(coils.coil(coil));
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d point_m(random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02),
                                  random.uniform(-0.01, 0.01));
    Eigen::VectorXd current_A(static_cast<Eigen::Index>(coils.count()));
    Eigen::Vector3d field_T(20e-6, 0.0, -45e-6);  // the earth's
    for (std::size_t coil = 0; coil < exact.size(); ++coil) {
      const auto at = static_cast<Eigen::Index>(coil);
      current_A[at] = random.uniform(-5.0, 5.0);
      field_T += current_A[at] * exact[coil].per_ampere(point_m);
    }
    for (Eigen::Index axis = 0; axis < 3; ++axis) field_T[axis] += noise_T * random.normal();
    samples.position_m.push_back(point_m);
    samples.current_A.push_back(current_A);
    samples.field_T.push_back(field_T);
  }
  return samples;
}

/// Each coil a little elsewhere than described.
CoilsDescription as_built(const CoilsDescription& described) {
  CoilsDescription built = described;
  built.each.clear();
  for (std::size_t i = 0; i < described.count(); ++i) {
    CoilDescription coil = described.coil(i);
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    coil.position_m[0] += 2e-3 * sign;
    coil.position_m[1] -= 1.5e-3;
    coil.position_m[2] += 1e-3 * sign;
    const Eigen::Vector3d axis = (coil.unit_axis() + Eigen::Vector3d(0.03, -0.02, 0.04 * sign)).normalized();
    coil.axis = {axis.x(), axis.y(), axis.z()};
    coil.gain = 1.0 + 0.05 * sign;
    built.each.push_back(coil);
  }
  return built;
}

TEST_CASE("coils are found where they stand, from samples with the noise of a magnetometer") {
  for (const RigDescription& rig : {tests::ring_rig(6), tests::ring_rig(8, 0.03), RigDescription{}}) {
    const CoilsDescription built = as_built(rig.coils);
    const FieldSamples samples = samples_of(built, 300, 5e-6);
    const CoilFit fit = fit_coils(rig.coils, samples);
    CHECK(fit.described.relative_rms > 0.03);
    CHECK(fit.held_out.relative_rms < 0.2 * fit.described.relative_rms);
    CHECK(fit.fitted.rms_T < 2.0 * std::sqrt(3.0) * 5e-6);
    CHECK(fit.background_T[2] == Approx(-45e-6).margin(5e-6));
    REQUIRE(fit.coils.each.size() == rig.coils.count());
    // What matters: the field where nobody measured, near the wall of a dish of 25 mm.
    for (std::size_t coil = 0; coil < built.each.size(); ++coil) {
      const StandingCoil truth(built.each[coil]), found(fit.coils.each[coil]);
      for (const Eigen::Vector3d& point_m :
           {Eigen::Vector3d(0.024, 0.0, 0.0), Eigen::Vector3d(0.0, -0.024, 0.0)})
        CHECK((found.per_ampere(point_m) - truth.per_ampere(point_m)).norm() <
              0.01 * truth.per_ampere(point_m).norm());
    }
    // The earth's field is none of the coils'.
    FieldSamples of_coils = samples;
    for (Eigen::Vector3d& field_T : of_coils.field_T) field_T -= Eigen::Vector3d(20e-6, 0.0, -45e-6);
    CHECK(field_error(fit.coils, of_coils).relative_rms <
          0.2 * field_error(rig.coils, of_coils).relative_rms);
    CHECK(field_error(fit.coils, samples).relative_rms > field_error(fit.coils, of_coils).relative_rms);
  }
}

TEST_CASE("what samples do not tell stays as it was described") {
  const RigDescription rig = tests::ring_rig(6);
  FieldSamples samples = samples_of(rig.coils, 40, 1e-6);
  for (Eigen::VectorXd& current_A : samples.current_A) current_A[5] *= 1e-9;  // hardly ever on
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples.field_T[i] = {20e-6, 0.0, -45e-6};
    for (std::size_t coil = 0; coil < 6; ++coil)
      samples.field_T[i] += samples.current_A[i][static_cast<Eigen::Index>(coil)] *
                            StandingCoil(rig.coils.each[coil]).per_ampere(samples.position_m[i]);
  }
  const CoilFit fit = fit_coils(rig.coils, samples);
  for (const double moved_m : fit.shifts[5].moved_m) CHECK(std::abs(moved_m) < 1e-4);
  CHECK(fit.shifts[5].gain == Approx(1.0).margin(1e-3));
}

TEST_CASE("samples are held against coils that were measured, but nothing of those is moved") {
  const CoilsDescription measured = tests::measured_small_ring_rig().coils;
  FieldSamples samples = samples_of(tests::small_ring_rig().coils, 60, 0.0);
  for (Eigen::Vector3d& field_T : samples.field_T)
    field_T += Eigen::Vector3d(20e-6, 0.0, 45e-6);  // 40 uT of x
  CHECK(field_error(measured, samples).relative_rms < 0.02);
  CHECK_THROWS_WITH(fit_coils(measured, samples), Catch::Contains("no winding to place"));
  samples.position_m[3] = {0.03, 0.0, 0.0};
  CHECK_THROWS_WITH(field_error(measured, samples), Catch::Contains("(30.0, 0.0, 0.0) mm is not known"));
}

TEST_CASE("samples that coils cannot explain are refused, with what it may be") {
  const RigDescription rig = tests::ring_rig(6);
  const FieldSamples good = samples_of(rig.coils, 100, 1e-6);
  CHECK_THROWS_WITH(fit_coils(RigDescription{}.coils, good), "the samples are of 6 coils, the rig has 4");
  FieldSamples swapped = good;
  for (Eigen::VectorXd& current_A : swapped.current_A) std::swap(current_A[0], current_A[3]);
  CHECK_THROWS_WITH(fit_coils(rig.coils, swapped), Catch::Contains("are two of them swapped"));
  CHECK_THROWS_WITH(fit_coils(rig.coils, samples_of(rig.coils, 12, 0.0)),
                    Catch::Contains("12 samples are too few"));
  FieldSamples inside = good;
  inside.position_m[7] = {0.09, 0.02, 0.0};
  CHECK_THROWS_WITH(field_error(rig.coils, inside),
                    Catch::Contains("(90.0, 20.0, 0.0) mm lies in the winding of coil c1"));
}

}  // namespace
}  // namespace lodestone::physics
