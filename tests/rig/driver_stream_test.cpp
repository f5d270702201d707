#include "lodestone/rig/driver_stream.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <string>

#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"

using namespace lodestone;

namespace {

std::string read_line(rig::SerialPort& port) {
  std::string line;
  for (int tries = 0; tries < 100 && (line.empty() || line.back() != '\n'); ++tries) {
    std::uint8_t byte = 0;
    if (port.read(&byte, 1, 0.1) == 1) line.push_back(static_cast<char>(byte));
  }
  return line;
}

/// Neither gone nor ended and waited for by nobody.
bool runs(pid_t id) {
  std::ifstream file("/proc/" + std::to_string(id) + "/stat");
  std::string number, name, state;
  return file >> number >> name >> state && state != "Z";
}

void write_line(rig::SerialPort& port, const std::string& line) {
  port.write(reinterpret_cast<const std::uint8_t*>(line.data()), line.size(), 0.1);
}

}  // namespace

TEST_CASE("a driver that is started speaks through its standard input and output, and ends with its stream") {
  auto stream = rig::open_driver_stream("process:echo $$; cat", 1.0, "key");
  const pid_t shell = std::stoi(read_line(*stream));
  write_line(*stream, "hello\n");
  CHECK(read_line(*stream) == "hello\n");
  CHECK(kill(shell, 0) == 0);
  stream.reset();
  CHECK(kill(shell, 0) != 0);
}

TEST_CASE("a driver that does not end with its stream is ended, and what it has started") {
  auto stream = rig::open_driver_stream("process:sleep 1000 & echo $!; wait", 1.0, "key");
  const pid_t sleeper = std::stoi(read_line(*stream));
  const common::SteadyClock clock;
  const double begun_s = clock.now_s();
  stream.reset();
  CHECK(clock.now_s() - begun_s < 5.0);
  for (int tries = 0; tries < 100 && runs(sleeper); ++tries) usleep(10000);  // it is nobody's of ours
  CHECK_FALSE(runs(sleeper));
}

TEST_CASE("a driver that cannot be started is gone when it is read from") {
  const auto stream = rig::open_driver_stream("process:exec /no/such/program 2>/dev/null", 1.0, "key");
  std::uint8_t byte = 0;
  CHECK_THROWS_WITH(stream->read(&byte, 1, 1.0), Catch::Contains("what it wrote to standard error says why"));
}

TEST_CASE("a driver that waits on a port is connected to, and one that does not is named") {
  const int door = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(bind(door, reinterpret_cast<sockaddr*>(&here), sizeof here) == 0);
  REQUIRE(listen(door, 1) == 0);
  socklen_t size = sizeof here;
  getsockname(door, reinterpret_cast<sockaddr*>(&here), &size);
  const std::string address = "tcp://127.0.0.1:" + std::to_string(ntohs(here.sin_port));
  const auto stream = rig::open_driver_stream(address, 1.0, "key");
  const int driver = accept(door, nullptr, nullptr);
  write_line(*stream, "hello\n");
  char got[8] = {};
  CHECK(read(driver, got, sizeof got) == 6);
  close(driver);
  close(door);
  CHECK_THROWS_WITH(
      rig::open_driver_stream(address, 1.0, "key"),
      Catch::Contains(address + " cannot be reached") && Catch::Contains("is it running there?"));
  CHECK_THROWS_WITH(rig::open_driver_stream("tcp://no.such.host.invalid:1", 1.0, "key"),
                    Catch::Contains("cannot be reached"));
}

TEST_CASE("another address is refused, with the key that holds it") {
  for (const char* bad : {"", "process:", "tcp://", "tcp://host", "tcp://:5",
                          "tcp://host:", "tcp://host:99999", "tcp://host:coils", "/dev/ttyACM0"})
    CHECK_THROWS_WITH(
        rig::open_driver_stream(bad, 1.0, "rig.driver.coils"),
        "rig.driver.coils = \"" + std::string(bad) + "\" must be process:COMMAND or tcp://HOST:PORT");
}
