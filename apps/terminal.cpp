#include "terminal.h"

#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <iostream>

#include "lodestone/common/error.h"
#include "lodestone/common/interrupt.h"

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

session::AskedOperator::Ask terminal_operator(const physics::RigDescription& rig) {
  if (!has_operator()) return {};
  return [sphere = rig.needle.is_sphere()](const geometry::Pose2& pose) {
    // A key from before the question answers nothing: hands may still be in the dish. What follows the
    // first byte of an arrow key would stop the run.
    tcflush(STDIN_FILENO, TCIFLUSH);
    std::printf("\nPlace the %s near x = %.0f mm, y = %.0f mm, ", sphere ? "sphere" : "needle",
                1e3 * pose.x_m, 1e3 * pose.y_m);
    if (!sphere)
      std::printf("its taped end towards %.0f degrees, ", pose.heading_rad * 180.0 / 3.14159265358979323846);
    std::printf("take your hands away and press any key. ");
    std::fflush(stdout);
    char key = 0;
    for (ssize_t got = 0; got != 1;) {
      got = read(STDIN_FILENO, &key, 1);
      if (common::interrupted()) throw common::Interrupted("stopped while the needle was to be placed");
      if (got == 0 || (got < 0 && errno != EINTR))
        throw common::HardwareError("nobody answers at the terminal");
    }
    tcflush(STDIN_FILENO, TCIFLUSH);
    std::printf("\n");
  };
}

void TerminalDialogue::say(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

}  // namespace lodestone::apps
