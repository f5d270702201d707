#include "lodestone/console/open_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "temporary_folder.h"

using namespace lodestone;
using console::OpenFile;

TEST_CASE("an open file stays the same one when its name goes to another") {
  const tests::TemporaryFolder folder;
  const std::string path = std::filesystem::canonical(folder.path()).string() + "/a.txt";
  std::ofstream(path) << "0123456789";
  const auto file = OpenFile::open(path);
  REQUIRE(file);
  CHECK(file->path() == path);
  CHECK(file->size_bytes() == 10);
  std::filesystem::remove(path);
  std::ofstream(path) << "another";
  char bytes[20];
  CHECK(std::string(bytes, file->read(2, bytes, 4)) == "2345");
  CHECK(std::string(bytes, file->read(8, bytes, 20)) == "89");
  CHECK(file->read(10, bytes, 20) == 0);
}

TEST_CASE("what is no plain file, or reached by a link, is not opened") {
  const tests::TemporaryFolder folder;
  const std::string root = std::filesystem::canonical(folder.path()).string();
  std::filesystem::create_directory(root + "/real");
  std::ofstream(root + "/real/a.txt") << "a";
  std::filesystem::create_symlink(root + "/real/a.txt", root + "/link.txt");
  std::filesystem::create_symlink(root + "/real", root + "/folder");
  REQUIRE(::mkfifo((root + "/pipe.txt").c_str(), 0600) == 0);
  CHECK(OpenFile::open(root + "/real/a.txt"));
  for (const char* name :
       {"/link.txt", "/folder/a.txt", "/real", "/pipe.txt", "/missing.txt", "/real/../real/a.txt"}) {
    CAPTURE(name);
    CHECK_FALSE(OpenFile::open(root + name));
  }
  CHECK_FALSE(OpenFile::open("/dev/null"));
  CHECK_FALSE(OpenFile::open(""));
}
