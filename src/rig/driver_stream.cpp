#include "lodestone/rig/driver_stream.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "descriptor_port.h"
#include "lodestone/common/clock.h"
#include "lodestone/common/error.h"

namespace lodestone::rig {

namespace {

constexpr char kProcess[] = "process:";
constexpr char kTcp[] = "tcp://";

/// A driver that was started, in a group of its own: Ctrl-C in the terminal is for this program, which then
/// has the driver switch off.
class ProcessPort final : public DescriptorPort {
 public:
  ProcessPort(int file, pid_t id, const std::string& command)
      : DescriptorPort(file, "driver " + command, "what it wrote to standard error says why"), id_(id) {}
  ~ProcessPort() override {
    close();
    common::SteadyClock clock;
    constexpr double kToEnd_s = 0.5, kLook_s = 0.01;
    const auto ended = [&] {
      for (double waited_s = 0.0; waited_s < kToEnd_s; waited_s += kLook_s) {
        if (waitpid(id_, nullptr, WNOHANG) != 0) return true;
        clock.sleep_until(clock.now_s() + kLook_s);
      }
      return false;
    };
    const bool by_itself = ended();
    kill(-id_, SIGKILL);      // and what it has started
    if (!by_itself) ended();  // one that waits for a dead device may not even be killed
  }

 private:
  pid_t id_;
};

std::unique_ptr<SerialPort> start(const std::string& command) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw common::HardwareError("driver " + command + " cannot be started: " + std::strerror(errno));
  const pid_t id = fork();
  if (id == 0) {
    setpgid(0, 0);
    for (const int end : {STDIN_FILENO, STDOUT_FILENO})
      if (ends[1] != end)
        dup2(ends[1], end);
      else  // where this program was started without
        fcntl(end, F_SETFD, 0);
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  const int error = errno;
  ::close(ends[1]);
  if (id < 0) {
    ::close(ends[0]);
    throw common::HardwareError("driver " + command + " cannot be started: " + std::strerror(error));
  }
  setpgid(id, id);  // whoever of the two comes first
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return std::make_unique<ProcessPort>(ends[0], id, command);
}

/// Whether the socket got through to the address in time.
bool connected(int file, const addrinfo& to, double timeout_s) {
  if (::connect(file, to.ai_addr, to.ai_addrlen) == 0) return true;
  if (errno != EINPROGRESS) return false;
  pollfd watched{file, POLLOUT, 0};
  if (poll(&watched, 1, static_cast<int>(1e3 * timeout_s)) <= 0) {
    errno = ETIMEDOUT;
    return false;
  }
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(file, SOL_SOCKET, SO_ERROR, &error, &size);
  errno = error;
  return error == 0;
}

std::unique_ptr<SerialPort> connect_to(const std::string& host, const std::string& port, double timeout_s) {
  const std::string name = kTcp + host + ":" + port;
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int code = getaddrinfo(host.c_str(), port.c_str(), &wanted, &found); code != 0)
    throw common::HardwareError("driver " + name + " cannot be reached: " + gai_strerror(code));
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> all(found, freeaddrinfo);
  std::string why;
  for (const addrinfo* to = found; to != nullptr; to = to->ai_next) {
    const int file = socket(to->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (file >= 0 && connected(file, *to, timeout_s)) {
      const int at_once = 1;
      setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
      return std::make_unique<DescriptorPort>(file, "driver " + name, "has it ended, was the cable pulled?");
    }
    why = std::strerror(errno);
    if (file >= 0) ::close(file);
  }
  throw common::HardwareError("driver " + name + " cannot be reached: " + why + "; is it running there?");
}

}  // namespace

std::unique_ptr<SerialPort> open_driver_stream(const std::string& address, double timeout_s,
                                               const std::string& key) {
  if (address.rfind(kProcess, 0) == 0 && address.size() > std::strlen(kProcess))
    return start(address.substr(std::strlen(kProcess)));
  const std::size_t colon = address.rfind(':');
  const std::string port = colon < address.size() ? address.substr(colon + 1) : "";
  const bool digits =
      !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  if (address.rfind(kTcp, 0) == 0 && colon > std::strlen(kTcp) && digits && std::stoi(port) < 65536)
    return connect_to(address.substr(std::strlen(kTcp), colon - std::strlen(kTcp)), port, timeout_s);
  throw common::ConfigError(key + " = \"" + address + "\" must be process:COMMAND or tcp://HOST:PORT");
}

}  // namespace lodestone::rig
