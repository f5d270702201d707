#include "lodestone/safety/operator_stop.h"

#include <poll.h>
#include <unistd.h>

#include "lodestone/common/interrupt.h"
#include "lodestone/safety/check.h"

namespace lodestone::safety {

struct OperatorStop::Terminal {
  bool key() const {
    pollfd watched{STDIN_FILENO, POLLIN, 0};
    char pressed = 0;
    return poll(&watched, 1, 0) == 1 && (watched.revents & POLLIN) != 0 &&
           read(STDIN_FILENO, &pressed, 1) == 1;
  }
  common::RawTerminal raw;
};

OperatorStop::OperatorStop(std::string file, bool keys) : file_(std::move(file)) {
  if (keys && isatty(STDIN_FILENO) == 1) terminal_ = std::make_unique<Terminal>();
}

OperatorStop::~OperatorStop() = default;

void OperatorStop::check() {
  if (common::interrupted()) throw Distrust("stopped by the user (signal)");
  if (terminal_ && terminal_->key()) throw Distrust("stopped by the user (key)");
  if (!file_.empty() && access(file_.c_str(), F_OK) == 0)
    throw Distrust("stopped by the user (" + file_ + " exists)");
}

}  // namespace lodestone::safety
