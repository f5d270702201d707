#include "lodestone/common/path_digest.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;
using common::path_digest;
using common::write_file_atomically;

TEST_CASE("a digest tells what a file or a folder holds, wherever it lies", "[unit]") {
  const tests::TemporaryFolder folder;
  CHECK(path_digest(folder / "none").empty());
  write_file_atomically(folder / "file", "abc");
  CHECK(path_digest(folder / "file") == common::sha256("abc"));
  for (const char* name : {"a", "b"}) {
    common::make_folders(folder / name + "/inner");
    write_file_atomically(folder / name + "/one", "1");
    write_file_atomically(folder / name + "/inner/two", "2");
  }
  const std::string of_a = path_digest(folder / "a");
  CHECK(of_a.size() == 64);
  CHECK(path_digest(folder / "b") == of_a);
  CHECK(path_digest(folder / "a/") == of_a);
  write_file_atomically(folder / "b/inner/two", "3");
  CHECK_FALSE(path_digest(folder / "b") == of_a);
  write_file_atomically(folder / "b/inner/two", "2");
  std::filesystem::rename(folder / "b/one", folder / "b/other");
  CHECK_FALSE(path_digest(folder / "b") == of_a);
}
