#include "lodestone/data/episode_bytes.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "same_episode.h"
#include "synthetic.h"

using namespace lodestone;

TEST_CASE("an episode comes back from its bytes; no other number of bytes makes one") {
  const data::Episode episode = tests::random_dataset(1, 9).episodes[0];
  const std::string bytes = data::to_bytes(episode);
  CHECK(bytes.size() == 10 * 3 * 8 + 9 * (2 * 8 + 3));
  const auto back = data::from_bytes(bytes, data::StateLayout::kPose);
  REQUIRE(back);
  tests::check_equal(*back, episode);
  CHECK_FALSE(data::from_bytes(bytes.substr(1), data::StateLayout::kPose));
  CHECK_FALSE(data::from_bytes(bytes + "12345678x", data::StateLayout::kPose));
  CHECK_FALSE(data::from_bytes("", data::StateLayout::kPose));
  CHECK(data::checksum(bytes).size() == 32);
  CHECK(data::checksum(bytes) != data::checksum(bytes.substr(1)));
  CHECK_NOTHROW(data::compare_checksum(episode, data::checksum(bytes), "here"));
  CHECK_THROWS_AS(data::compare_checksum(episode, data::checksum(bytes.substr(1)), "here"),
                  common::DataError);
}

TEST_CASE("placements are kept, and an episode without their number began with one") {
  data::Episode episode = tests::random_dataset(1, 9).episodes[0];
  const std::string one = data::to_bytes(episode);
  for (const std::int64_t placements : {0, 2, 300}) {
    episode.placements = placements;
    const std::string bytes = data::to_bytes(episode);
    CHECK(bytes.size() == one.size() + 8);
    const auto back = data::from_bytes(bytes, data::StateLayout::kPose);
    REQUIRE(back);
    tests::check_equal(*back, episode);
  }
  CHECK(data::from_bytes(one, data::StateLayout::kPose)->placements == 1);
}
