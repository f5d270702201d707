#include "lodestone/common/csv_table.h"

#include <sys/stat.h>

#include <catch2/catch.hpp>

#include "lodestone/common/files.h"
#include "temporary_folder.h"

using namespace lodestone;
using common::CsvTable;

TEST_CASE("a table is read row by row, whatever program wrote it") {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "a.csv",
                                "\xEF\xBB\xBFname, x_m\r\n\r\n\"a \"\"b\"\", c\", +1e-3 \r\nd,x\n");
  CsvTable table(folder / "a.csv");
  CHECK(table.header() == std::vector<std::string>{"name", "x_m"});
  CHECK(table.has_columns({"x_m"}));
  CHECK_FALSE(table.has_columns({"x_m", "y_m"}));
  CHECK(table.column("x_m") == 1);
  REQUIRE(table.next());
  CHECK(table.line() == 3);
  CHECK(table.text(0) == "a \"b\", c");
  CHECK(table.number(1) == 1e-3);
  REQUIRE(table.next());
  CHECK_THROWS_WITH(table.number(1), Catch::Contains("a.csv:4: column 2 (x_m): \"x\" must be a number"));
  CHECK_FALSE(table.next());
}

TEST_CASE("rows of another width, doubled columns and missing files are named") {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "a.csv", "a,b\n1\n1,2,3\n");
  CsvTable table(folder / "a.csv");
  table.next();
  CHECK_THROWS_WITH(table.check_width(), Catch::Contains("a.csv:2: column 2 (b) is missing"));
  table.next();
  CHECK_THROWS_WITH(table.check_width(), Catch::Contains("a.csv:3: column 3 is one too many"));
  common::write_file_atomically(folder / "b.csv", "a,a\n");
  CHECK_THROWS_WITH(CsvTable(folder / "b.csv"), Catch::Contains("column a appears twice"));
  CHECK_THROWS_AS(CsvTable(folder / "none.csv"), common::DataError);
}

TEST_CASE("a sign too many, an open quote and what is no file are refused") {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "a.csv",
                                "a\n+-1\n+\n++1\n\"1\n+.5\n" + std::string(500, 'x') + "\n");
  CsvTable table(folder / "a.csv");
  for (const char* cell : {"+-1", "+", "++1"}) {
    table.next();
    CHECK_THROWS_WITH(table.number(0), Catch::Contains("\"" + std::string(cell) + "\" must be a number"));
  }
  table.next();
  CHECK_THROWS_WITH(table.check_width(), Catch::Contains("a.csv:5: a quote is opened"));
  table.next();
  CHECK(table.number(0) == 0.5);
  table.next();
  CHECK_THROWS_WITH(table.number(0), Catch::Contains(std::string(200, 'x') + "...\" must be"));
  common::write_file_atomically(folder / "b.csv", "a,\"b\n1,2\n");
  CHECK_THROWS_WITH(CsvTable(folder / "b.csv"), Catch::Contains("b.csv:1: a quote is opened"));
  REQUIRE(::mkfifo((folder / "pipe.csv").c_str(), 0600) == 0);
  CHECK_THROWS_AS(CsvTable(folder / "pipe.csv"), common::IoError);
  CHECK_THROWS_AS(CsvTable("/dev/zero"), common::IoError);
}

TEST_CASE("cells may be separated by other characters, and numbers have a decimal comma") {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "a.csv", "made by a logger\n\nt;x\n0,5;\"1,25\"\n1;2.5\n");
  CsvTable table(folder / "a.csv", {';', ',', 2});
  CHECK(table.header() == std::vector<std::string>{"t", "x"});
  REQUIRE(table.next());
  CHECK(table.line() == 4);
  CHECK(table.number(0) == 0.5);
  CHECK(table.number(1) == 1.25);
  REQUIRE(table.next());
  CHECK_THROWS_WITH(table.number(1), Catch::Contains("a number with a decimal comma"));
}

TEST_CASE("blanks and tabs in a row separate once, and a file without a header numbers its columns") {
  const tests::TemporaryFolder folder;
  common::write_file_atomically(folder / "a.txt", "  0.0   1.5\t-2 \n 0.1 1.6 \t -3\n");
  CsvTable table(folder / "a.txt", {' ', '.', 0});
  CHECK(table.header() == std::vector<std::string>{"1", "2", "3"});
  REQUIRE(table.next());
  table.check_width();
  CHECK(table.line() == 1);
  CHECK(table.number(2) == -2.0);
  REQUIRE(table.next());
  table.check_width();
  CHECK(table.number(2) == -3.0);
  CHECK_FALSE(table.next());
}
