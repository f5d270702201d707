#include "lodestone/physics/measured_field.h"

#include <catch2/catch.hpp>

#include "lodestone/common/artefact.h"
#include "lodestone/common/error.h"

using namespace lodestone;

namespace {

/// One coil with a uniform field along z and a background along it.
physics::MeasuredField uniform() {
  physics::MeasuredField field;
  field.degree = 1;
  field.low_m = {-0.01, -0.01, 0.0};
  field.high_m = {0.01, 0.01, 0.02};
  field.coils_T_per_A = {{2e-3, 0.0, 0.0}};
  field.background_T = {1e-3, 0.0, 0.0};
  return field;
}

}  // namespace

TEST_CASE("a measured field is linear in the currents, over what is there without them") {
  const physics::MeasuredField field = uniform();
  const Eigen::Vector3d none = field.field_T(Eigen::VectorXd::Zero(1), {0.0, 0.0, 0.01});
  CHECK(none.isApprox(Eigen::Vector3d(0.0, 0.0, 1e-3)));
  CHECK(field.field_T(Eigen::VectorXd::Constant(1, -3.0), {0.01, 0.0, 0.0})
            .isApprox(Eigen::Vector3d(0.0, 0.0, -5e-3)));
  CHECK_THROWS_AS(field.field_T(Eigen::VectorXd::Zero(2), {0.0, 0.0, 0.01}), common::LogicFault);
}

TEST_CASE("outside of what was measured, nothing is said") {
  CHECK_THROWS_WITH(uniform().field_T(Eigen::VectorXd::Zero(1), {0.0, 0.0, -0.001}),
                    Catch::Contains("(0.0, 0.0, -1.0) mm is not known: z was measured from 0.0 to 20.0 mm"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(uniform().field_T(Eigen::VectorXd::Zero(1), {nan, 0.0, 0.01}), common::DataError);
}

TEST_CASE("a file of another shape is refused") {
  physics::MeasuredField field = uniform();
  const common::Json whole = common::artefact_to_json(field);
  CHECK(common::artefact_from_json<physics::MeasuredField>(whole, "field.json").coils_T_per_A ==
        field.coils_T_per_A);
  const auto refused = [&](const char* key, const common::Json& value, const std::string& what) {
    common::Json json = whole;
    json[key] = value;
    CHECK_THROWS_WITH(common::artefact_from_json<physics::MeasuredField>(json, "field.json"),
                      Catch::Contains("field.json") && Catch::Contains(what));
  };
  refused("degree", 0, "degree = 0");
  refused("degree", 2, "8 numbers, not 3");
  refused("coils_T_per_A", common::Json::array(), "a coil at least");
  refused("coils_T_per_A", {{1.0}}, "3 numbers, not 1");
  refused("high_m", {0.01, 0.01, 0.0}, "low_m must be below high_m");
  refused("scale_m", 0.0, "scale_m");
}
