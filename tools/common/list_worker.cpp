#include "tools/common/list_worker.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string_view>

#include "libvpm/core/error.h"

namespace vpm::tools {
namespace {

// In the command line of a worker: NAME --config FILE works-on-a-list SOCKET.
constexpr const char* kWorks = "works-on-a-list";

[[noreturn]] void refuse_process() {
  refuse(std::string("no process can be started: ") + std::strerror(errno));
}

int memory_file(const char* name) {
  const int file = ::memfd_create(name, MFD_CLOEXEC);
  if (file < 0) refuse_process();
  return file;
}

// Writes the text over what the file holds.
void replace_content(int file, const std::string& text) {
  if (::ftruncate(file, 0) != 0 ||
      ::pwrite(file, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()))
    refuse(std::string("no run can be started: ") + std::strerror(errno));
}

// Reads a byte; false where the process at the other end is no more.
bool receive(int socket, unsigned char& byte) {
  ssize_t count = 0;
  do count = ::read(socket, &byte, 1);
  while (count < 0 && errno == EINTR);
  return count == 1;
}

void send(int socket, unsigned char byte) {
  // Where nobody reads any more, receive() tells so.
  static_cast<void>(::send(socket, &byte, 1, MSG_NOSIGNAL));
}

// Returns the environment of this process, followed by null. `visible`, NAME=VALUE, stands for the
// variable of that name, unless it is empty.
std::vector<char*> environment_with(std::string& visible) {
  const std::string_view name = std::string_view(visible).substr(0, visible.find('=') + 1);
  std::vector<char*> environment;
  for (char** one = environ; *one != nullptr; ++one)
    if (name.empty() || !std::string_view(*one).starts_with(name)) environment.push_back(*one);
  if (!visible.empty()) environment.push_back(visible.data());
  environment.push_back(nullptr);
  return environment;
}

}  // namespace

std::string Ended::fault() const {
  if (WIFSIGNALED(status))
    return std::string("its process was ended by a signal: ") + ::strsignal(WTERMSIG(status));
  constexpr std::string_view kError = ": error: ";
  for (auto line = said.rbegin(); line != said.rend(); ++line)
    if (const std::size_t k = line->find(kError); k != line->npos)
      return line->substr(k + kError.size());
  return "its process ended with exit status " + std::to_string(WEXITSTATUS(status));
}

Worker::Descriptor::~Descriptor() {
  ::close(number);
}

Worker::Worker(const std::string& gpu)
    : configuration_{memory_file("configuration")}, said_{memory_file("said")} {
  std::array<int, 2> sockets{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0) refuse_process();
  socket_.number = sockets[0];
  const Descriptor its_end{sockets[1]};
  std::string file = "/proc/self/fd/" + std::to_string(configuration_.number);
  std::string socket = std::to_string(its_end.number), option = "--config", works = kWorks;
  char* const words[] = {program_invocation_name, option.data(), file.data(), works.data(),
                         socket.data(),           nullptr};
  std::string visible = gpu.empty() ? "" : std::string(kVisibleGpus) + "=" + gpu;
  const std::vector<char*> environment = environment_with(visible);
  const pid_t parent = ::getpid();
  process_ = ::fork();
  if (process_ == 0) become(words, environment.data(), its_end.number, parent);
  if (process_ < 0) refuse_process();
}

// Calls only what a process may call after fork() that had other threads.
void Worker::become(char* const* words, char* const* environment, int socket, pid_t parent) const {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(1);
  const int nothing = ::open("/dev/null", O_RDWR);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(nothing, STDOUT_FILENO);
  ::dup2(said_.number, STDERR_FILENO);
  for (const int file : {configuration_.number, socket}) ::fcntl(file, F_SETFD, 0);
  ::execve("/proc/self/exe", words, environment);
  ::_exit(127);
}

Worker::~Worker() {
  dismiss();
  if (process_ > 0) ::waitpid(process_, nullptr, 0);
}

void Worker::dismiss() const {
  if (process_ > 0) ::kill(process_, SIGTERM);
}

void Worker::begin(const std::string& configuration) {
  replace_content(configuration_.number, configuration);
  replace_content(said_.number, "");
  ::lseek(said_.number, 0, SEEK_SET);  // where the process goes on
  send(socket_.number, 0);
}

Ended Worker::end() {
  Ended ended;
  unsigned char code = 0;
  if (receive(socket_.number, code)) {
    ended.status = W_EXITCODE(code, 0);
  } else {
    while (::waitpid(process_, &ended.status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
  }
  std::string text(static_cast<std::size_t>(::lseek(said_.number, 0, SEEK_END)), '\0');
  text.resize(static_cast<std::size_t>(
      std::max<ssize_t>(0, ::pread(said_.number, text.data(), text.size(), 0))));
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) ended.said.push_back(line);
  return ended;
}

int run_or_work(int argc, char** argv, int (*program)(int, char**)) {
  if (argc != 5 || argv[3] != std::string_view(kWorks)) return program(argc, argv);
  const int socket = std::atoi(argv[4]);
  ::fcntl(socket, F_SETFD, FD_CLOEXEC);
  argv[3] = nullptr;
  for (unsigned char byte = 0; receive(socket, byte);)
    send(socket, static_cast<unsigned char>(program(3, argv)));
  return 0;
}

}  // namespace vpm::tools
