#include "bench_session.h"

#include <termios.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <iostream>

#include "lodestone/common/error.h"
#include "lodestone/common/log.h"

namespace lodestone::apps {

bool has_operator() { return isatty(STDIN_FILENO) == 1; }

bool confirm(const std::string& question, bool yes) {
  if (yes) {
    std::printf("%s yes\n", question.c_str());
    return true;
  }
  if (!has_operator()) {
    std::printf("%s no (nobody to ask; --yes answers for you)\n", question.c_str());
    return false;
  }
  std::printf("%s [y/N] ", question.c_str());
  std::fflush(stdout);
  std::string answer;
  std::getline(std::cin, answer);
  return !answer.empty() && (answer[0] == 'y' || answer[0] == 'Y');
}

std::unique_ptr<session::RigSession> open_bench(const rig::RigConfig& rig,
                                                const session::SensingConfig& sensor,
                                                safety::SafetyConfig safety, const std::string& out) {
  if (safety.stop_file.empty() && !out.empty()) safety.stop_file = out + "/STOP";
  session::AskedOperator::Ask ask;
  if (has_operator())
    ask = [](const geometry::Pose2& pose) {
      // A key from before the question answers nothing: hands may still be in the dish. What follows the
      // first byte of an arrow key would stop the run.
      tcflush(STDIN_FILENO, TCIFLUSH);
      std::printf(
          "\nPlace the needle near x = %.0f mm, y = %.0f mm, its taped end towards %.0f degrees, take your "
          "hands away and press any key. ",
          1e3 * pose.x_m, 1e3 * pose.y_m, pose.heading_rad * 180.0 / 3.14159265358979323846);
      std::fflush(stdout);
      char key = 0;
      if (read(STDIN_FILENO, &key, 1) != 1) throw common::HardwareError("nobody answers at the terminal");
      tcflush(STDIN_FILENO, TCIFLUSH);
      std::printf("\n");
    };
  auto bench = session::make_serial_session(rig, sensor, safety, ask);
  common::log_info("bench connected on " + rig.serial.port + "; Ctrl-C" +
                   (has_operator() ? ", any key" : "") + " or the file " + safety.stop_file + " stops it");
  return bench;
}

}  // namespace lodestone::apps
