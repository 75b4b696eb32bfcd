#include "tests/unit/daemon/program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <stdexcept>

extern char** environ;

namespace gateway::test {
namespace {

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

Program::Program(const std::vector<std::string>& arguments, const std::vector<std::string>& variables, Output output) {
  std::vector<std::string> words{GATEWAY_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<std::string> environment = variables;  // The first of a name counts.
  for (char** variable = environ; *variable != nullptr; ++variable) {
    environment.emplace_back(*variable);
  }
  Pipe pipe = make_pipe();
  environment.insert(environment.begin(),
                     "JOURNAL_STREAM=" + (output == Output::journal ? as_journal(pipe.in.get()) : std::string()));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, pipe.in.get(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, pipe.in.get(), STDERR_FILENO);
  posix_spawn_file_actions_addclose(&actions, pipe.in.get());
  posix_spawn_file_actions_addclose(&actions, pipe.out.get());
  const int failed = ::posix_spawn(&process_, GATEWAY_PROGRAM, &actions, nullptr, pointers_to(words).data(),
                                   pointers_to(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    throw std::runtime_error("cannot start " GATEWAY_PROGRAM);
  }
  reading_ = std::move(pipe.out);
}

Program::~Program() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
}

void Program::signal(int number) const {
  ::kill(process_, number);
}

bool Program::read_on() {
  pollfd waiting{.fd = reading_.get(), .events = POLLIN, .revents = 0};
  std::array<char, 4096> buffer{};
  if (::poll(&waiting, 1, 30000) != 1) {
    return false;
  }
  const ssize_t length = ::read(reading_.get(), buffer.data(), buffer.size());
  if (length <= 0) {
    return false;
  }
  output_.append(buffer.data(), static_cast<std::size_t>(length));
  return true;
}

bool Program::says(std::string_view text) {
  std::size_t at = output_.find(text, found_);
  for (; at == std::string::npos; at = output_.find(text, found_)) {
    if (!read_on()) {
      return false;
    }
  }
  found_ = at + text.size();
  return true;
}

int Program::exit_code() {
  while (read_on()) {
  }
  const Descriptor ending(static_cast<int>(::syscall(SYS_pidfd_open, process_, 0)));
  pollfd waiting{.fd = ending.get(), .events = POLLIN, .revents = 0};
  if (::poll(&waiting, 1, 30000) != 1) {
    ::kill(process_, SIGKILL);
  }
  int status = 0;
  ::waitpid(process_, &status, 0);
  process_ = 0;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TemporaryFile::TemporaryFile(std::string_view content) {
  std::string name = (std::filesystem::temp_directory_path() / "gateway-test-XXXXXX").string();
  const Descriptor file(::mkstemp(name.data()));
  path_ = name;
  if (::write(file.get(), content.data(), content.size()) != static_cast<ssize_t>(content.size())) {
    throw std::runtime_error("cannot write " + name);
  }
}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace gateway::test
