#include "lodestone/console/served_files.h"

#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "temporary_folder.h"

using namespace lodestone;
using console::RequestHead;
using console::ServedFiles;

namespace {

/// Two folders to be served, and a secret beside them.
struct Folders {
  Folders() : served({{"/runs/", folder / "runs"}, {"/recordings/", folder / "recordings"}}) {
    std::filesystem::create_directories(folder / "runs/a/.hidden");
    put("runs/a/report.html", "<p>report</p>");
    put("runs/a/with space.csv", "1,2");
    put("runs/a/x..y.txt", "dots");
    put("runs/a/.hidden/b.txt", "hidden");
    put("runs/a/.b.txt", "hidden");
    put("runs/a/weights.safetensors", "weights");
    put("secret.txt", "secret");
    put("secret.key", "secret");
  }
  void put(const std::string& name, const std::string& content) { std::ofstream(folder / name) << content; }
  void link(const std::string& to, const std::string& name) {
    std::filesystem::create_symlink(folder / to, folder / name);
  }
  std::optional<console::Response> find(const std::string& target, const std::string& range = "") const {
    RequestHead head;
    head.method = "GET";
    head.target = target;
    head.range = range;
    return served.find(head);
  }
  int status(const std::string& target) const {
    const auto found = find(target);
    return found ? found->status : 0;
  }
  static std::string content(const console::Response& response) {
    std::string text(response.length_bytes, '\0');
    text.resize(response.file->read(response.first_byte, text.data(), text.size()));
    return text;
  }

  tests::TemporaryFolder folder;
  ServedFiles served;
};

}  // namespace

TEST_CASE("files are found by their name, encoded or not") {
  const Folders folders;
  const auto report = folders.find("/runs/a/report.html?x=../y#z");
  REQUIRE(report);
  REQUIRE(report->status == 200);
  CHECK(report->content_type == "text/html; charset=utf-8");
  CHECK(Folders::content(*report) == "<p>report</p>");
  CHECK(folders.status("/runs/a/with%20space.csv") == 200);
  CHECK(folders.status("/runs/%61/r%65port.html") == 200);
  CHECK(folders.status("/runs/a%2Freport.html") == 200);
  CHECK(folders.status("/runs/a/x..y.txt") == 200);
  CHECK(folders.status("/recordings/a.mp4") == 404);  // the folder is not there yet
  CHECK_FALSE(folders.find("/"));
  CHECK_FALSE(folders.find("/runs"));
  CHECK_FALSE(folders.find("/x/runs/a/report.html"));
}

TEST_CASE("pages that others wrote see nothing of the console") {
  const Folders folders;
  const auto policy_of = [&](const std::string& target) {
    const auto found = folders.find(target);
    REQUIRE(found);
    for (const console::Header& header : found->headers)
      if (header.name == "Content-Security-Policy") return header.value;
    return std::string();
  };
  const std::string policy = policy_of("/runs/a/report.html");
  CHECK(policy.find("default-src 'none'") == 0);
  CHECK(policy.find("sandbox allow-scripts") != std::string::npos);
  CHECK(policy.find("allow-same-origin") == std::string::npos);
  CHECK(policy_of("/runs/a/with%20space.csv").empty());
}

TEST_CASE("no name leads out of a folder, to a hidden file, or to one of another kind") {
  const Folders folders;
  for (const char* target : {"/runs/",
                             "/runs/a",
                             "/runs/a/",
                             "/runs/../secret.txt",
                             "/runs/a/../../secret.txt",
                             "/runs/%2e%2e/secret.txt",
                             "/runs/%2E%2E%2Fsecret.txt",
                             "/runs/..%2fsecret.txt",
                             "/runs/a/..%5c..%5csecret.txt",
                             "/runs/..\\secret.txt",
                             "/runs//secret.txt",
                             "/runs/a//report.html",
                             "/runs/./a/report.html",
                             "/runs/a/./report.html",
                             "/runs/%252e%252e/secret.txt",
                             "/runs/a/report.html%00",
                             "/runs/a/report.html%00.txt",
                             "/runs/a/%00/../report.html",
                             "/runs/a/report.html/",
                             "/runs/a/report.html/.",
                             "/runs/a/.b.txt",
                             "/runs/a/%2eb.txt",
                             "/runs/a/.hidden/b.txt",
                             "/runs/a/weights.safetensors",
                             "/runs/a/missing.html",
                             "/runs/a/report.html%",
                             "/runs/a/report.html%2",
                             "/runs/a/report.html%zz",
                             "/runs/a/report.html%0a",
                             "/runs/%c0%ae%c0%ae/secret.txt",
                             "/runs/?/a/report.html",
                             "/runs/a/.html",
                             "/runs/a/REPORT.HTML"}) {
    CAPTURE(target);
    CHECK(folders.status(target) == 404);
  }
  CHECK(folders.status("/runs/" + std::string(3000, 'a') + ".txt") == 404);
  CHECK(folders.status("/runs/" + std::string(300, 'a') + ".txt") == 404);
  CHECK(folders.status("/runs/" + folders.folder.path() + "/secret.txt") == 404);
}

TEST_CASE("links inside a folder are followed, and those out of it are not") {
  Folders folders;
  folders.link("runs/a/report.html", "runs/good.html");
  folders.link("runs/a", "runs/b");
  folders.link("secret.txt", "runs/out.txt");
  folders.link("", "runs/up");
  folders.link("runs/a/.b.txt", "runs/unhidden.txt");
  folders.link("runs/a/weights.safetensors", "runs/weights.txt");
  folders.link("runs/loop.txt", "runs/loop.txt");
  std::filesystem::create_symlink("/dev/zero", folders.folder / "runs/zero.txt");
  REQUIRE(::mkfifo((folders.folder / "runs/pipe.txt").c_str(), 0600) == 0);
  CHECK(folders.status("/runs/good.html") == 200);
  CHECK(folders.status("/runs/b/report.html") == 200);
  for (const char* target : {"/runs/out.txt", "/runs/up/secret.txt", "/runs/unhidden.txt",
                             "/runs/weights.txt", "/runs/loop.txt", "/runs/zero.txt", "/runs/pipe.txt"}) {
    CAPTURE(target);
    CHECK(folders.status(target) == 404);
  }
}

TEST_CASE("a folder whose name begins as a served one's is none") {
  Folders folders;
  std::filesystem::create_directories(folders.folder / "runs-private");
  folders.put("runs-private/a.txt", "private");
  folders.link("runs-private/a.txt", "runs/a.txt");
  CHECK(folders.status("/runs/a.txt") == 404);
  CHECK_FALSE(folders.find("/runs-private/a.txt"));
}

TEST_CASE("a range of a file is cut out as it is asked for") {
  Folders folders;
  std::filesystem::create_directories(folders.folder / "recordings");
  folders.put("recordings/a.mp4", "0123456789");
  struct Case {
    const char* range;
    int status;
    const char* content;
    const char* said;
  };
  const Case cases[] = {
      {"", 200, "0123456789", ""},
      {"bytes=0-", 206, "0123456789", "bytes 0-9/10"},
      {"bytes=2-4", 206, "234", "bytes 2-4/10"},
      {"bytes=9-9", 206, "9", "bytes 9-9/10"},
      {"bytes=5-99", 206, "56789", "bytes 5-9/10"},
      {"bytes=-3", 206, "789", "bytes 7-9/10"},
      {"bytes=-99", 206, "0123456789", "bytes 0-9/10"},
      {"bytes=0-1,4-5", 200, "0123456789", ""},  // several may be ignored
      {"bytes=4-2", 200, "0123456789", ""},
      {"bytes=x-2", 200, "0123456789", ""},
      {"bytes=2-x", 200, "0123456789", ""},
      {"bytes=-", 200, "0123456789", ""},
      {"bytes=", 200, "0123456789", ""},
      {"bytes", 200, "0123456789", ""},
      {"lines=1-2", 200, "0123456789", ""},
      {"bytes=--3", 200, "0123456789", ""},
      {"bytes=99999999999999999999-", 200, "0123456789", ""},
  };
  for (const Case& one : cases) {
    CAPTURE(one.range);
    const auto found = folders.find("/recordings/a.mp4", one.range);
    REQUIRE(found);
    CHECK(found->status == one.status);
    REQUIRE(found->file);
    CHECK(Folders::content(*found) == one.content);
    CHECK(found->content_type == "video/mp4");
    CHECK(found->headers.back().value == (one.said[0] == '\0' ? "bytes" : one.said));
  }
  for (const char* range : {"bytes=10-", "bytes=10-20", "bytes=-0"}) {
    CAPTURE(range);
    const auto found = folders.find("/recordings/a.mp4", range);
    REQUIRE(found);
    CHECK(found->status == 416);
    CHECK_FALSE(found->file);
    CHECK(found->headers.at(0).value == "bytes */10");
  }
  folders.put("recordings/empty.mp4", "");
  CHECK(folders.find("/recordings/empty.mp4")->length_bytes == 0);
  CHECK(folders.find("/recordings/empty.mp4", "bytes=0-")->status == 416);
}
