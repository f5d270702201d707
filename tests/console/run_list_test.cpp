#include "lodestone/console/run_list.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "lodestone/common/error.h"
#include "lodestone/common/files.h"
#include "lodestone/console/served_files.h"
#include "lodestone/runs/run_folder.h"
#include "temporary_folder.h"

using namespace lodestone;
using common::Json;

TEST_CASE("runs are listed, and the address of a report leads to it, whatever the run is called") {
  const tests::TemporaryFolder folder;
  CHECK(console::run_list(folder / "nowhere").empty());
  CHECK(console::run_list(folder.path()).empty());
  const std::string odd = "a/<b>50% #1?</b> \xc3\xa4\xff";
  {
    runs::RunFolder run({folder / odd, "collect", Json::object()});
    run.begin();
    run.finish();
  }
  common::write_file_atomically(folder / (odd + "/report.html"), "found");
  runs::RunFolder second({folder / "second", "adapt", Json::object()});
  second.begin();
  std::filesystem::create_symlink("report.html", folder / "second/report.html");  // leads to itself
  const Json runs = console::run_list(folder.path());
  REQUIRE(runs.size() == 2);
  CHECK(runs[0]["name"] == odd);
  CHECK(runs[0]["state"] == "finished");
  CHECK(runs[1]["state"] == "running");
  CHECK(runs[1]["report"].is_null());
  const std::string address = runs[0]["report"];
  CHECK(address == "/runs/a/%3Cb%3E50%25%20%231%3F%3C/b%3E%20%C3%A4%FF/report.html");
  console::RequestHead head;
  head.target = address;
  const auto report = console::ServedFiles({{console::kRuns, folder.path()}}).find(head);
  REQUIRE(report);
  CHECK(report->status == 200);
  CHECK(report->length_bytes == 5);
}

TEST_CASE("a run whose state cannot be read is told") {
  const tests::TemporaryFolder folder;
  common::make_folders(folder / "a");
  common::write_file_atomically(folder / "a/run.json", "{");
  CHECK_THROWS_AS(console::run_list(folder.path()), common::DataError);
}

TEST_CASE("recordings are listed, with their films where there are any") {
  const tests::TemporaryFolder folder;
  CHECK(console::recording_list(folder / "nowhere").empty());
  common::write_file_atomically(folder / "a.csv", "time_s\n0\n2.5\n");
  common::write_file_atomically(folder / "b.csv", "time_s\n0\n");
  common::write_file_atomically(folder / "b.mp4", "");
  const Json films = console::recording_list(folder.path());
  REQUIRE(films.size() == 2);
  CHECK(films[0]["video"] == "/recordings/b.mp4");
  CHECK(films[1]["video"].is_null());
  CHECK(films[1]["seconds"] == 2.5);
}
