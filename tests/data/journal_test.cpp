#include "lodestone/data/journal.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/data/episode_bytes.h"
#include "same_episode.h"
#include "synthetic.h"
#include "temporary_folder.h"

using namespace lodestone;
using Catch::Matchers::Contains;
using data::AfterDamage;

namespace {

void write_journal(const std::string& path, const data::Dataset& dataset) {
  data::JournalWriter writer(path, dataset.info, AfterDamage::kRefuse);
  for (const data::Episode& episode : dataset.episodes) writer.write(episode);
  writer.sync();
}

void check_first(const data::JournalContent& found, const data::Dataset& dataset, std::size_t count) {
  REQUIRE(found.episodes.size() == count);
  for (std::size_t e = 0; e < count; ++e) tests::check_equal(found.episodes[e], dataset.episodes[e]);
}

}  // namespace

TEST_CASE("a journal cut at any byte holds every episode that is whole, and goes on behind them") {
  const tests::TemporaryFolder folder;
  const data::Dataset dataset = tests::random_dataset(4, 3);
  write_journal(folder / "whole", dataset);
  const std::string whole = common::read_file(folder / "whole");
  const std::size_t episode_bytes = data::to_bytes(dataset.episodes[0]).size() + 40;
  const std::size_t info_bytes = whole.size() - 4 * episode_bytes;
  for (std::size_t size = info_bytes; size <= whole.size(); ++size) {
    const std::string path = folder / "cut";
    common::write_file_atomically(path, whole.substr(0, size));
    const std::size_t count = (size - info_bytes) / episode_bytes;
    check_first(data::read_journal(path), dataset, count);
    data::JournalWriter writer(path, dataset.info, AfterDamage::kRefuse);
    CHECK(writer.episodes() == static_cast<std::int64_t>(count));
    CHECK(writer.transitions() == static_cast<std::int64_t>(3 * count));
    for (std::size_t e = count; e < 4; ++e) writer.write(dataset.episodes[e]);
    REQUIRE(common::read_file(path) == whole);
  }
  // A power cut may leave the length without the numbers.
  common::write_file_atomically(folder / "zeros",
                                whole.substr(0, info_bytes) + std::string(episode_bytes, '\0'));
  CHECK(data::read_journal(folder / "zeros").episodes.empty());
  for (std::size_t size = 0; size < info_bytes; ++size) {
    common::write_file_atomically(folder / "none", whole.substr(0, size));
    CHECK_THROWS_AS(data::read_journal(folder / "none"), common::DataError);
  }
}

TEST_CASE("any byte that changed is noticed; damage before whole episodes is refused, or they are dropped") {
  const tests::TemporaryFolder folder;
  const data::Dataset dataset = tests::random_dataset(3, 2);
  write_journal(folder / "whole", dataset);
  const std::string whole = common::read_file(folder / "whole");
  const std::size_t episode_bytes = data::to_bytes(dataset.episodes[0]).size() + 40;
  const std::size_t info_bytes = whole.size() - 3 * episode_bytes;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    const std::string path = folder / "damaged";
    common::write_file_atomically(path, bytes);
    const std::size_t before = at < info_bytes ? 0 : (at - info_bytes) / episode_bytes;
    if (at < info_bytes) {
      CHECK_THROWS_AS(data::read_journal(path, AfterDamage::kDrop), common::DataError);
      continue;
    }
    check_first(data::read_journal(path, AfterDamage::kDrop), dataset, before);
    if (before < 2)
      CHECK_THROWS_WITH(data::read_journal(path),
                        Contains("episode " + std::to_string(before)) && Contains("truncate -s"));
    else
      check_first(data::read_journal(path), dataset, before);
  }
}

TEST_CASE("a full disk is an IoError, keeps the episodes before it, and leaves no part of the next") {
  const tests::TemporaryFolder folder;
  const std::string path = folder / "a.journal";
  const data::Dataset dataset = tests::random_dataset(40, 200);
  const pid_t child = fork();
  if (child == 0) {
    // A limit on file size fails writes as a full disk does.
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{200000, 200000};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_journal(path, dataset);
    } catch (const common::IoError& error) {
      _exit(std::string(error.what()).find("the episodes before it are kept") != std::string::npos ? 17 : 1);
    } catch (...) {
    }
    _exit(1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  REQUIRE(WIFEXITED(status));
  REQUIRE(WEXITSTATUS(status) == 17);
  const data::JournalContent found = data::read_journal(path);
  check_first(found, dataset, found.episodes.size());
  CHECK(found.episodes.size() >= 10);
  CHECK(found.dropped_bytes == 0);
}

TEST_CASE("a journal costs at most twice its numbers, and takes nothing that is no number") {
  const tests::TemporaryFolder folder;
  for (const int steps : {1, 25}) {
    const data::Dataset dataset = tests::random_dataset(50, steps);
    write_journal(folder / std::to_string(steps), dataset);
    const std::size_t numbers = 50 * data::to_bytes(dataset.episodes[0]).size();
    CHECK(common::read_file(folder / std::to_string(steps)).size() <= 2 * numbers);
  }
  data::Dataset dataset = tests::random_dataset(2, 3);
  dataset.episodes[1].observations[4] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_WITH(write_journal(folder / "nan", dataset), Contains("row 1") && Contains("y_m"));
  CHECK(data::read_journal(folder / "nan").episodes.size() == 1);
  dataset.info.layout = data::StateLayout::kPosition;
  CHECK_THROWS_WITH(data::JournalWriter(folder / "nan", dataset.info, AfterDamage::kRefuse),
                    Contains("another state layout"));
}
