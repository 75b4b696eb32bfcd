#include "tests/support/mosquitto.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <thread>

extern char** environ;

namespace support {
namespace {

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

bool accepts_connections(std::uint16_t port) {
  const int client = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in address = loopback(port);
  // The sockets API takes every kind of address by this one type.
  const bool accepted = connect(client, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(client);
  return accepted;
}

}  // namespace

std::uint16_t free_port() {
  const int server = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = loopback(0);
  socklen_t length = sizeof(address);
  const bool bound = bind(server, reinterpret_cast<const sockaddr*>(&address), length) == 0 &&
                     getsockname(server, reinterpret_cast<sockaddr*>(&address), &length) == 0;
  close(server);
  if (!bound) {
    throw std::runtime_error("no free port on loopback");
  }
  return ntohs(address.sin_port);
}

Mosquitto::Mosquitto(const std::string& extra) : port_(free_port()) {
  std::string name = (std::filesystem::temp_directory_path() / "mqtt-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("no directory for the broker");
  }
  directory_ = name;
  std::ofstream(directory_ / "mosquitto.conf") << "listener " << port_ << " 127.0.0.1\n"
                                               << "allow_anonymous true\n"
                                               << "persistence false\n"
                                               << "user root\n"
                                               << "log_type error\n"
                                               << extra;
}

Mosquitto::~Mosquitto() {
  stop();
  std::error_code ignored;
  std::filesystem::remove_all(directory_, ignored);
}

bool Mosquitto::start() {
  const std::string configuration = (directory_ / "mosquitto.conf").string();
  const std::string log = (directory_ / "log").string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  std::string program = "mosquitto";
  std::string option = "-c";
  std::string value = configuration;
  const std::array<char*, 4> arguments{program.data(), option.data(), value.data(), nullptr};
  // Debian keeps it out of the path of ordinary users.
  int failed = posix_spawnp(&process_, "mosquitto", &actions, nullptr, arguments.data(), environ);
  if (failed != 0) {
    failed = posix_spawn(&process_, "/usr/sbin/mosquitto", &actions, nullptr, arguments.data(), environ);
  }
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    process_ = 0;
    return false;
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!accepts_connections(port_)) {
    if (std::chrono::steady_clock::now() > end) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

void Mosquitto::stop() {
  if (process_ <= 0) {
    return;
  }
  kill(process_, SIGCONT);
  // Asked again: mosquitto forgets a signal that comes after it listens and before its main loop begins.
  for (int i = 0; i < 1000; ++i) {
    kill(process_, SIGTERM);
    if (waitpid(process_, nullptr, WNOHANG) != 0) {
      process_ = 0;
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
  process_ = 0;
}

void Mosquitto::freeze() const {
  kill(process_, SIGSTOP);
}

void Mosquitto::resume() const {
  kill(process_, SIGCONT);
}

}  // namespace support
