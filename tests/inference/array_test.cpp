#include "lodestone/inference/array.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"

using namespace lodestone;
using inference::Array;
using inference::ElementType;

TEST_CASE("an array knows its type and shape, and gives its numbers only as what they are", "[unit]") {
  const Array array(std::vector<float>{1, 2, 3, 4, 5, 6}, {2, 3});
  CHECK(array.type() == ElementType::kFloat32);
  CHECK(array.size() == 6);
  CHECK(array.bytes() == 24);
  CHECK(array.text() == "[2, 3] float32");
  CHECK(array.data<float>()[5] == 6.0F);
  CHECK(array.to_double() == std::vector<double>{1, 2, 3, 4, 5, 6});
  CHECK_THROWS_AS(array.data<double>(), common::LogicFault);
  CHECK_THROWS_AS(Array(std::vector<float>(5), {2, 3}), common::LogicFault);
}

TEST_CASE("every type of number comes back", "[unit]") {
  CHECK(Array(std::vector<double>{0.5}, {1}).to_vector<double>() == std::vector<double>{0.5});
  CHECK(Array(std::vector<std::int64_t>{-7}, {}).to_double() == std::vector<double>{-7.0});
  CHECK(Array(std::vector<std::uint8_t>{255, 1}, {2}).to_double() == std::vector<double>{255.0, 1.0});
  CHECK(Array(std::vector<float>(), {0, 3}).size() == 0);
  CHECK(Array().size() == 0);
}

TEST_CASE("identical means type, shape and bits", "[unit]") {
  const Array one(std::vector<float>{1, 2}, {2});
  CHECK(identical(one, Array(std::vector<float>{1, 2}, {2})));
  CHECK_FALSE(identical(one, Array(std::vector<float>{1, 3}, {2})));
  CHECK_FALSE(identical(one, Array(std::vector<float>{1, 2}, {2, 1})));
  CHECK_FALSE(identical(one, Array(std::vector<double>{1, 2}, {2})));
}
