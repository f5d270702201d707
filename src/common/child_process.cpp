#include "lodestone/common/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>

#include "lodestone/common/error.h"

namespace lodestone::common {

ChildProcess::ChildProcess(const std::vector<std::string>& words) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    throw IoError("cannot start " + words.front() + ": too many files are open");
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  id_ = fork();
  if (id_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGINT);
    const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
    dup2(nothing, STDIN_FILENO);
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    execv(arguments.front(), arguments.data());
    _exit(127);
  }
  close(ends[1]);
  output_ = ends[0];
  if (id_ < 0) {
    close(output_);
    throw IoError("cannot start " + words.front() + ": too many processes are running");
  }
}

ChildProcess::~ChildProcess() {
  if (id_ > 0) {
    kill(id_, SIGKILL);
    finish();
  }
  close(output_);
}

std::optional<std::string> ChildProcess::read(double timeout_s) {
  pollfd watched{output_, POLLIN, 0};
  if (poll(&watched, 1, static_cast<int>(1e3 * timeout_s)) <= 0) return "";
  std::array<char, 4096> part{};
  const ssize_t count = ::read(output_, part.data(), part.size());
  if (count < 0 && (errno == EINTR || errno == EAGAIN)) return "";
  if (count <= 0) return std::nullopt;
  return std::string(part.data(), static_cast<std::size_t>(count));
}

void ChildProcess::interrupt() noexcept {
  if (id_ > 0) kill(id_, SIGINT);
}

int ChildProcess::finish() {
  int status = 0;
  while (waitpid(id_, &status, 0) < 0 && errno == EINTR) {
  }
  id_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace lodestone::common
