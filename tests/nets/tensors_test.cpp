#include "lodestone/nets/tensors.h"

#include <catch2/catch.hpp>

#include <ATen/ATen.h>

#include "lodestone/common/error.h"

namespace lodestone::nets {
namespace {

TEST_CASE("a tensor that outlives its array keeps the numbers", "[unit]") {
  at::Tensor tensor;
  {
    const inference::Array array(std::vector<float>{1, 2, 3}, {3});
    tensor = to_tensor(array);
  }
  CHECK(at::equal(tensor, tensor_from({1.0, 2.0, 3.0}, {3}, at::kFloat)));
  CHECK(to_array(tensor).text() == "[3] float32");
  CHECK_THROWS_AS(to_array(at::ones({2}, at::kBool)), common::LogicFault);
}

TEST_CASE("an array of a turned tensor holds its rows in order", "[unit]") {
  const at::Tensor tensor = tensor_from({1, 2, 3, 4, 5, 6}, {2, 3});
  CHECK(to_array(tensor.t()).to_double() == std::vector<double>{1, 4, 2, 5, 3, 6});
  CHECK(to_vector(tensor.t()) == std::vector<double>{1, 4, 2, 5, 3, 6});
}

TEST_CASE("a tensor of another shape, type or order is named", "[unit]") {
  const at::Tensor tensor = at::zeros({2, 3});
  CHECK_NOTHROW(check_tensor(tensor, {2, 3}, at::kFloat, "it"));
  CHECK_THROWS_WITH(check_tensor(tensor, {3, 2}, at::kFloat, "it"),
                    Catch::Contains("it is [2, 3] float, expected contiguous [3, 2] Float"));
  CHECK_THROWS_AS(check_tensor(tensor, {2, 3}, at::kDouble, "it"), common::LogicFault);
  CHECK_THROWS_AS(check_tensor(tensor.t(), {3, 2}, at::kFloat, "it"), common::LogicFault);
}

TEST_CASE("numbers that do not fill a shape are refused", "[unit]") {
  CHECK_THROWS_AS(tensor_from({1.0, 2.0, 3.0}, {2, 2}), common::LogicFault);
  CHECK(tensor_from({0.5, 1.5}, {2, 1}, at::kFloat).scalar_type() == at::kFloat);
}

}  // namespace
}  // namespace lodestone::nets
