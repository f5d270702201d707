#include "lodestone/physics/field_fit.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/common/random.h"
#include "lodestone/physics/finite_coil.h"

using namespace lodestone;
using physics::FieldSamples;

namespace {

FieldSamples octomag() {
  return physics::read_field_samples(LODESTONE_SOURCE_DIR "/tests/physics/octomag_field.csv");
}

/// Every fifth sample, or all others.
FieldSamples part(const FieldSamples& samples, bool fifth) {
  FieldSamples taken;
  taken.coils = samples.coils;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if ((i % 5 == 0) != fifth) continue;
    taken.position_m.push_back(samples.position_m[i]);
    taken.current_A.push_back(samples.current_A[i]);
    taken.field_T.push_back(samples.field_T[i]);
  }
  return taken;
}

/// Samples of the paper's coils +x and +y around the dish's centre, exact.
FieldSamples air_cores(std::size_t count) {
  const physics::FiniteCoil coil(physics::CoilGeometry{});
  const double distance_m = physics::CoilGeometry{}.centre_distance_m;
  common::RandomStream random(1, "samples");
  FieldSamples samples;
  samples.coils = 2;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d p(random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02),
                            random.uniform(-0.01, 0.01));
    const Eigen::Vector2d current(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0));
    Eigen::Vector3d field = Eigen::Vector3d::Zero();
    for (Eigen::Index which = 0; which < 2; ++which) {  // its axis is x, or y
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(which);
      const Eigen::Vector3d from = p - distance_m * axis;
      const Eigen::Vector3d away = from - from.dot(axis) * axis;
      const physics::AxialRadial per_A = coil.per_ampere(from.dot(axis), away.norm());
      field += current[which] * (per_A.axial * axis + per_A.radial * away.normalized());
    }
    samples.position_m.push_back(p);
    samples.current_A.push_back(current);
    samples.field_T.push_back(field);
  }
  return samples;
}

}  // namespace

TEST_CASE("the field of eight coils with cores is explained to half a per cent where it was not fitted") {
  const FieldSamples samples = octomag();
  const physics::FieldFit fit = physics::fit_field(part(samples, false));
  CHECK(fit.field.coils_T_per_A.size() == 8);
  const physics::FieldError unseen = physics::field_error(fit.field, part(samples, true));
  CHECK(unseen.samples == 400);
  CHECK(unseen.relative_rms < 0.004);
  CHECK(unseen.relative_rms > 0.0024);  // the sensor's noise alone is 0.25 %
  // What it says of itself holds for samples that it has not seen at all.
  CHECK(fit.held_out.relative_rms == Approx(unseen.relative_rms).epsilon(0.1));
  CHECK(unseen.direction_median_deg < 0.3);
  CHECK(fit.held_out_by_degree[0] > 0.1);
}

TEST_CASE("a measured field is linear in the currents, over what is there without them") {
  const physics::MeasuredField field = physics::fit_field(air_cores(600)).field;
  const Eigen::Vector3d point_m(0.01, -0.004, 0.002);
  const Eigen::Vector3d none = field.field_T(Eigen::VectorXd::Zero(2), point_m);
  const Eigen::Vector2d one(2.0, -1.0);
  CHECK((field.field_T(3.0 * one, point_m) - none).isApprox(3.0 * (field.field_T(one, point_m) - none)));
  CHECK_THROWS_WITH(field.field_T(one, {0.0, 0.0, 0.02}), Catch::Contains("is not known"));
  CHECK_THROWS_AS(field.field_T(Eigen::VectorXd::Zero(3), point_m), common::LogicFault);
}

TEST_CASE("coils take a measured field, each its own, and keep all else") {
  physics::CoilsDescription paper;
  paper.resistance_20C_ohm = {1.0, 2.0, 3.0, 4.0};
  physics::MeasuredField field = physics::fit_field(air_cores(600)).field;
  CHECK_THROWS_WITH(field.applied_to(paper), "the samples are of 2 coils, the rig has 4");
  field.coils_T_per_A.push_back(field.coils_T_per_A[0]);
  field.coils_T_per_A.push_back(field.coils_T_per_A[1]);
  const physics::CoilsDescription coils = field.applied_to(paper);
  REQUIRE(coils.each.size() == 4);
  CHECK(coils.each[1].name == "-x");
  CHECK(coils.each[3].harmonics_T_per_A == field.coils_T_per_A[1]);
  CHECK(coils.measured == field.region);
  CHECK(coils.resistance_20C_ohm == paper.resistance_20C_ohm);
  CHECK_NOTHROW(coils.validate());
}

TEST_CASE("windings without cores are found again from their field") {
  const physics::FieldFit fit = physics::fit_field(air_cores(600));
  CHECK(fit.held_out.relative_rms < 1e-3);
  const FieldSamples more = air_cores(700);
  CHECK(physics::field_error(fit.field, part(more, true)).relative_rms < 2e-3);
}

TEST_CASE("samples that say too little, or that cannot be a field, are refused") {
  CHECK_THROWS_WITH(physics::fit_field(air_cores(4)), Catch::Contains("4 samples are too few for 2 coils"));
  FieldSamples flat = air_cores(100);
  for (Eigen::Vector3d& position : flat.position_m) position.z() = 0.003;
  CHECK_THROWS_WITH(physics::fit_field(flat), Catch::Contains("same z"));
  FieldSamples swapped = air_cores(600);
  for (Eigen::Vector3d& field : swapped.field_T) std::swap(field.y(), field.z());
  CHECK_THROWS_WITH(physics::fit_field(swapped), Catch::Contains("two of them swapped"));
  FieldSamples mixed = air_cores(600);
  for (std::size_t i = 0; i < 100; ++i) mixed.field_T[i] *= 10.0;  // gauss among milliteslas
  CHECK_THROWS_WITH(physics::fit_field(mixed), Catch::Contains("in another unit"));
  const physics::FieldFit fit = physics::fit_field(air_cores(600));
  CHECK_THROWS_WITH(physics::field_error(fit.field, octomag()),
                    Catch::Contains("of 8 coils, the field of 2"));
}
