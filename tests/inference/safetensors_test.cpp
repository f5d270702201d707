#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/inference/checkpoint.h"

namespace lodestone::inference {
namespace {

TEST_CASE("a safetensors file starts with the length of its header, which is JSON", "[unit]") {
  const std::string content = encode_safetensors({{"x", Array(std::vector<float>{1.0F, 2.0F}, {2})}});
  const auto length = static_cast<unsigned char>(content[0]);
  REQUIRE(content.size() == 8u + length + 8u);
  const auto header = common::Json::parse(content.substr(8, length));
  CHECK(header.at("x").at("dtype") == "F32");
  CHECK(header.at("x").at("data_offsets") == common::Json({0, 8}));
  const char one[] = {0, 0, '\x80', '\x3f'};
  CHECK(content.substr(8u + length, 4) == std::string(one, 4));
}

TEST_CASE("malformed safetensors content never reads outside the file", "[unit]") {
  const std::string good = encode_safetensors({{"x", Array(std::vector<float>{0, 1, 2, 3, 4, 5}, {2, 3})}});
  for (std::size_t length = 0; length < good.size(); ++length) {
    CHECK_THROWS_AS(decode_safetensors(good.substr(0, length), "file"), common::CheckpointError);
  }
  const auto with_header = [](std::string header) {
    std::string content(8, '\0');
    content[0] = static_cast<char>(header.size() & 0xff);
    content[1] = static_cast<char>(header.size() >> 8);
    return content + header + std::string(8, '\0');
  };
  for (
      const char* header :
      {R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[0,99]}})",
       R"({"x":{"dtype":"F32","shape":[-2],"data_offsets":[0,8]}})",
       R"({"x":{"dtype":"F32","shape":[4611686018427387904,4],"data_offsets":[0,0]}})",
       R"({"x":{"dtype":"F16","shape":[4],"data_offsets":[0,8]}})",
       R"({"x":{"dtype":"F32","shape":[2.5],"data_offsets":[0,8]}})",
       R"({"x":{"dtype":"F32","shape":[1e30],"data_offsets":[0,8]}})",
       R"({"x":{"dtype":"F32","shape":[2,1,1,1,1,1,1,1,1],"data_offsets":[0,8]}})",
       R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[-8,0]}})",
       R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[0,8,8]}})",
       R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[0,8]},"x":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})",
       R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[0,8]},"y":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}})",
       R"({"x":[1]})", R"([1,2)", R"([1,2])"}) {
    INFO(header);
    CHECK_THROWS_AS(decode_safetensors(with_header(header), "file"), common::CheckpointError);
  }
  CHECK_THROWS_WITH(decode_safetensors(with_header(std::string(60'000, '[')), "file"),
                    Catch::Contains("deeper than 64"));
}

}  // namespace
}  // namespace lodestone::inference
