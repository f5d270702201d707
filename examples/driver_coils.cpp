// A driver outside the program: the coil controller on a serial port, a real or an emulated one, through
// Lodestone's own library. In rig.json: "backend": "driver",
//
//   "driver": {"coils": "process:build/examples/driver_coils /dev/ttyACM0"}
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>

#include "lodestone/common/json.h"
#include "lodestone/rig/serial_coils.h"
using namespace lodestone;

common::Json answer_to(const common::Json& asked, const char* port,
                       std::unique_ptr<rig::SerialCoils>& coils) {
  if (asked["do"] == "hello") {
    rig::SerialConfig line;
    line.port = port;
    line.max_pulse_s = asked["max_pulse_s"];
    physics::CoilsDescription description;  // the paper's four
    for (const common::Json& coil : asked["coils"])
      description.max_current_A =
          std::max({0.0, coil["largest_A"].get<double>(), -coil["smallest_A"].get<double>()});
    coils = std::make_unique<rig::SerialCoils>(line, description);
    return {{"protocol", 1}, {"name", "coil controller, by C++"}};
  }
  if (asked["do"] == "status") {
    const rig::CoilStatus status = coils->status();
    return {{"current_A", status.current_A.list()}, {"faults", status.faults}};
  }
  if (asked["do"] == "pulse")
    coils->apply({physics::PerCoil(asked["current_A"].get<std::vector<double>>()), asked["duration_s"]});
  else if (asked["do"] == "stop")
    coils->stop();
  else if (asked["do"] == "clear")
    coils->clear_faults();
  else if (asked["do"] != "ping")
    throw common::DataError("unknown request");
  return common::Json::object();
}

int main(int, char** words) {
  std::unique_ptr<rig::SerialCoils> coils;
  for (std::array<unsigned char, 4> head{}; std::fread(head.data(), 1, 4, stdin) == 4;) {
    std::string text(head[0] | head[1] << 8 | head[2] << 16, '\0');
    if (std::fread(text.data(), 1, text.size(), stdin) < text.size()) break;  // the program has gone
    const common::Json asked = common::parse_json(text, "standard input");
    common::Json answer = {{"id", asked["id"]}};
    try {
      answer.update(answer_to(asked, words[1], coils));
    } catch (const std::exception& error) {
      answer["error"] = error.what();
    }
    text = answer.dump();
    for (std::size_t i = 0; i < 4; ++i) std::putchar(static_cast<int>(text.size() >> 8 * i & 0xff));
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
  }
}
