#include "lodestone/common/files.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "lodestone/common/error.h"
#include "temporary_folder.h"

using namespace lodestone::common;
namespace fs = std::filesystem;

TEST_CASE("SHA-256 of known texts") {
  CHECK(sha256("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST_CASE("an atomic write replaces the file and leaves nothing else") {
  const lodestone::tests::TemporaryFolder folder;
  write_file_atomically(folder / "a.txt", "one");
  write_file_atomically(folder / "a.txt", "two");
  CHECK(read_file(folder / "a.txt") == "two");
  CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1);
}

TEST_CASE("a full disk is an IoError and keeps the file as it was") {
  const lodestone::tests::TemporaryFolder folder;
  write_file_atomically(folder / "a.txt", "good");
  const pid_t child = fork();
  if (child == 0) {
    // A limit on file size fails writes as a full disk does.
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_file_atomically(folder / "a.txt", std::string(100000, 'x'));
    } catch (const IoError&) {
      _exit(7);
    }
    _exit(0);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  CHECK(WEXITSTATUS(status) == 7);
  CHECK(read_file(folder / "a.txt") == "good");
  CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1);
}

TEST_CASE("a folder is replaced whole, whether or not it was there") {
  const lodestone::tests::TemporaryFolder folder;
  for (const char* content : {"one", "two"}) {
    fs::create_directory(folder / "staged");
    std::ofstream(folder / "staged/a.txt") << content;
    replace_folder(folder / "staged", folder / "final");
    CHECK(read_file(folder / "final/a.txt") == content);
    CHECK_FALSE(fs::exists(folder / "staged"));
  }
}

TEST_CASE("reading what is not there names it") {
  CHECK_THROWS_WITH(read_file("/nowhere/x"), Catch::Contains("/nowhere/x"));
  CHECK_THROWS_AS(read_file("/"), IoError);
}

TEST_CASE("a file takes the place of another, or is named in an IoError") {
  const lodestone::tests::TemporaryFolder folder;
  write_file_atomically(folder / "a.txt", "old");
  write_file_atomically(folder / "a.part", "new");
  replace_file(folder / "a.part", folder / "a.txt");
  CHECK(read_file(folder / "a.txt") == "new");
  CHECK_FALSE(fs::exists(folder / "a.part"));
  CHECK_THROWS_AS(replace_file(folder / "a.part", folder / "a.txt"), IoError);
  CHECK(read_file(folder / "a.txt") == "new");
}

TEST_CASE("only a file is read, and only up to the size that is asked for") {
  const lodestone::tests::TemporaryFolder folder;
  write_file_atomically(folder / "a.txt", "four");
  CHECK(read_file(folder / "a.txt", 4) == "four");
  CHECK_THROWS_WITH(read_file(folder / "a.txt", 3), Catch::Contains("a.txt: it holds 4 bytes, at most 3"));
  CHECK_THROWS_WITH(read_file(folder.path()), Catch::Contains("it is a folder"));
  CHECK_THROWS_WITH(read_file(folder / "none"), Catch::Contains("No such file"));
  REQUIRE(::mkfifo((folder / "pipe").c_str(), 0600) == 0);
  for (const std::string& path : {folder / "pipe", std::string("/dev/zero")}) {
    CHECK_THROWS_AS(read_file(path), IoError);
    CHECK_THROWS_WITH(check_is_file(path), Catch::Contains("not a file"));
  }
}
