#include "episode_batch.h"

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "same_episode.h"
#include "synthetic.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;

namespace {

constexpr std::uintmax_t kFileBytes = 100'000;

std::vector<data::Episode> episodes_of_many_lengths() {
  std::vector<data::Episode> episodes;
  for (const int steps : {1, 7, 1, 30})
    episodes.push_back(tests::random_dataset(1, steps, static_cast<std::uint64_t>(steps)).episodes[0]);
  episodes[2].placements = 0;
  return episodes;
}

}  // namespace

TEST_CASE("episodes of many lengths come back from one batch") {
  const tests::TemporaryFolder folder;
  const data::Handle file = data::create_file(folder / "a.h5", H5P_DEFAULT);
  const std::vector<data::Episode> episodes = episodes_of_many_lengths();
  REQUIRE(data::write_episode_batch(file.get(), episodes, data::StateLayout::kPose));
  data::ArrayReader reader(kFileBytes);
  const std::vector<data::Episode> back =
      data::read_episode_batch(file.get(), data::StateLayout::kPose, reader, "here");
  REQUIRE(back.size() == episodes.size());
  for (std::size_t e = 0; e < back.size(); ++e) tests::check_equal(back[e], episodes[e]);
}

TEST_CASE("lengths that do not fit the arrays are refused") {
  const tests::TemporaryFolder folder;
  data::silence_hdf5();
  const data::Handle file = data::create_file(folder / "a.h5", H5P_DEFAULT);
  REQUIRE(data::write_episode_batch(file.get(), episodes_of_many_lengths(), data::StateLayout::kPose));
  const std::vector<std::vector<std::int64_t>> wrong = {{1, 7, 1, 29},  {1, 7, 1, 31},        {1, 7, 31},
                                                        {-1, 9, 1, 30}, {1, 7, 1, INT64_MAX}, {7, 1, 1, 30}};
  for (const std::vector<std::int64_t>& steps : wrong) {
    REQUIRE(H5Ldelete(file.get(), "steps", H5P_DEFAULT) >= 0);
    REQUIRE(data::write_array(file.get(), "steps", H5T_STD_I64LE, H5T_NATIVE_INT64, steps.data(),
                              {steps.size()}));
    data::ArrayReader reader(kFileBytes);
    CHECK_THROWS_WITH(data::read_episode_batch(file.get(), data::StateLayout::kPose, reader, "here"),
                      Contains("damaged"));
  }
}
