// What strangers do to a Modbus server, and what its clients notice of it.
//
// modbus_crowd poll PORT SECONDS
//   8 clients of 127.0.0.1 read ten registers each 10 ms, for so long alone and then beside 500 connections of
//   127.0.0.2: a third leaves a request halfway and comes again when it is thrown out, a third sends a byte each 300
//   ms, a third says nothing. Prints two lines, alone and beside: how many answers; within how many µs 50 %, 99 %, 99.9
//   % and all of them came; and how many connections of strangers there are at the end.
// modbus_crowd full PORT
//   32 silent connections of 127.0.0.2 and 127.0.0.3, then one of 127.0.0.4, then a client of 127.0.0.9, which asks.
//   Prints how the third fared, `refused` or `taken`, and after how many µs the client was answered, since it began to
//   connect.
// modbus_crowd deaf PORT SECONDS
//   Asks until the server takes no more, reads nothing for so long, and then everything. Prints how many requests it
//   sent and how many answers it got.
// Status 1 where a client got no answer or lost its connection.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;
using Bytes = std::vector<std::uint8_t>;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kClients = 8;
constexpr std::size_t kStrangers = 500;
constexpr milliseconds kPollPeriod{10};
constexpr milliseconds kBytePeriod{300};
constexpr milliseconds kArrival{5};  // between two strangers
constexpr seconds kPatience{5};
constexpr std::array<std::uint8_t, 12> kRequest{0, 1, 0, 0, 0, 6, 255, 3, 0, 0, 0, 10};
constexpr std::size_t kAnswer = 29;

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// A connection that never waits.
class Socket {
 public:
  Socket(const char* from, std::uint16_t port, int buffer = 0) : descriptor_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (buffer != 0) {
      ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
      ::setsockopt(descriptor_, SOL_SOCKET, SO_SNDBUF, &buffer, sizeof buffer);
    }
    const int on = 1;
    ::setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    const sockaddr_in own = address(from, 0);
    const sockaddr_in server = address("127.0.0.1", port);
    if (::bind(descriptor_, std::bit_cast<const sockaddr*>(&own), sizeof own) != 0 ||
        ::connect(descriptor_, std::bit_cast<const sockaddr*>(&server), sizeof server) != 0) {
      fail(from);
    }
  }
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)), lost_(other.lost_) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(lost_, other.lost_);
    return *this;
  }
  ~Socket() {
    if (descriptor_ >= 0) {
      ::close(descriptor_);
    }
  }

  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  /// How many bytes were taken; 0 where none can be.
  std::size_t send(const std::uint8_t* bytes, std::size_t count) {
    const ssize_t sent = ::send(descriptor_, bytes, count, MSG_DONTWAIT | MSG_NOSIGNAL);
    lost_ = lost_ || (sent < 0 && errno != EAGAIN);
    return sent > 0 ? static_cast<std::size_t>(sent) : 0;
  }
  /// How many bytes came.
  std::size_t receive() {
    std::array<std::uint8_t, 4096> bytes{};
    const ssize_t count = ::recv(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    lost_ = lost_ || count == 0 || (count < 0 && errno != EAGAIN);
    return count > 0 ? static_cast<std::size_t>(count) : 0;
  }
  [[nodiscard]] bool lost() const noexcept { return lost_; }

 private:
  static sockaddr_in address(const char* host, std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    ::inet_pton(AF_INET, host, &address.sin_addr);
    return address;
  }

  int descriptor_;
  bool lost_ = false;
};

struct Client {
  Socket socket;
  Clock::time_point due;
  Clock::time_point asked{};
  std::size_t missing = 0;  // bytes of the answer
};

enum class Habit : std::uint8_t { half, slow, idle };

struct Stranger {
  Socket socket;
  Habit habit;
  Clock::time_point due;
  std::size_t said = 0;
};

class Crowd {
 public:
  explicit Crowd(std::uint16_t port) : port_(port) {
    for (std::size_t i = 0; i < kClients; ++i) {
      clients_.push_back({Socket("127.0.0.1", port), Clock::now() + i * kPollPeriod / kClients});
    }
  }

  using Times = std::vector<std::int64_t>;  // in µs

  /// How long answers took; whoever is to come has come before it counts.
  Times run(Clock::duration time, std::size_t strangers) {
    while (strangers_.size() < strangers) {
      const Clock::time_point next = Clock::now() + kArrival;
      strangers_.push_back({Socket("127.0.0.2", port_), static_cast<Habit>(strangers_.size() % 3), Clock::now()});
      turn_until(next);
    }
    times_.clear();
    turn_until(Clock::now() + time);
    return times_;
  }
  /// How many of the strangers are still connected.
  std::size_t send_away() {
    return static_cast<std::size_t>(std::ranges::count(std::exchange(strangers_, {}), false,
                                                       [](const Stranger& each) { return each.socket.lost(); }));
  }

 private:
  // Reading the clock is a system call here, so all of a turn have one time.
  void turn_until(Clock::time_point end) {
    for (Clock::time_point now = Clock::now(); now < end; now = Clock::now()) {
      const auto answered = wait(now);
      now = Clock::now();
      for (std::size_t i = 0; i < kClients; ++i) {
        go_on(clients_[i], answered.at(i).revents != 0, now);
      }
      for (Stranger& stranger : strangers_) {
        if (now >= stranger.due) {
          go_on(stranger, now);
        }
      }
    }
  }

  std::array<pollfd, kClients> wait(Clock::time_point now) {
    std::array<pollfd, kClients> waiting{};
    Clock::time_point next = now + milliseconds(1);
    for (std::size_t i = 0; i < kClients; ++i) {
      waiting.at(i) = {clients_[i].socket.descriptor(), POLLIN, 0};
      next = clients_[i].missing == 0 ? std::min(next, clients_[i].due) : next;
    }
    const timespec time{0, std::chrono::nanoseconds(std::max(Clock::duration::zero(), next - now)).count()};
    ::ppoll(waiting.data(), waiting.size(), &time, nullptr);
    return waiting;
  }

  void go_on(Client& client, bool answered, Clock::time_point now) {
    if (answered) {
      client.missing -= std::min(client.missing, client.socket.receive());
      if (client.missing == 0) {
        times_.push_back(std::chrono::duration_cast<std::chrono::microseconds>(now - client.asked).count());
      }
    }
    if (client.missing == 0 && now >= client.due) {
      client.asked = Clock::now();
      client.socket.send(kRequest.data(), kRequest.size());
      client.missing = kAnswer;
      client.due = std::max(client.due + kPollPeriod, now);
    }
    if (client.socket.lost() || (client.missing != 0 && now - client.asked > kPatience)) {
      throw std::runtime_error("a client got no answer");
    }
  }

  void go_on(Stranger& stranger, Clock::time_point now) {
    stranger.due = now + kBytePeriod;
    stranger.socket.receive();
    if (stranger.socket.lost()) {
      stranger.socket = Socket("127.0.0.2", port_);
      stranger.said = 0;
    }
    if (stranger.habit == Habit::slow || (stranger.habit == Habit::half && stranger.said < kRequest.size() / 2)) {
      stranger.socket.send(&kRequest.at(stranger.said), 1);
      stranger.said = (stranger.said + 1) % kRequest.size();
    }
  }

  std::uint16_t port_;
  std::vector<Client> clients_;
  std::vector<Stranger> strangers_;
  Times times_;
};

void print(Crowd::Times times) {
  std::ranges::sort(times);
  for (const std::size_t per_mille : {500U, 990U, 999U, 1000U}) {
    std::printf("%lld ", static_cast<long long>(times.at(std::min(times.size() - 1, times.size() * per_mille / 1000))));
  }
  std::printf("%zu\n", times.size());
}

// What is alone is measured before and after, so that a machine that becomes busy is so for both.
void poll(std::uint16_t port, seconds time) {
  Crowd crowd(port);
  Crowd::Times alone = crowd.run(time / 2, 0);
  const Crowd::Times beside = crowd.run(time, kStrangers);
  const std::size_t strangers = crowd.send_away();
  std::ranges::copy(crowd.run(time / 2, 0), std::back_inserter(alone));
  print(alone);
  print(beside);
  std::printf("%zu\n", strangers);
}

void wait_for(Socket& socket, short events) {
  pollfd waiting{socket.descriptor(), events, 0};
  ::poll(&waiting, 1, static_cast<int>(milliseconds(kPatience).count()));
}

// True: closed at once, as one that is refused.
bool is_refused(Socket& socket) {
  pollfd waiting{socket.descriptor(), POLLIN, 0};
  ::poll(&waiting, 1, 500);
  socket.receive();
  return socket.lost();
}

void full(std::uint16_t port) {
  std::vector<Socket> silent;
  for (int i = 0; i < 32; ++i) {
    silent.emplace_back(i % 2 == 0 ? "127.0.0.2" : "127.0.0.3", port);
  }
  Socket reader("127.0.0.4", port);
  const bool refused = is_refused(reader);
  const Clock::time_point begun = Clock::now();
  Socket scada("127.0.0.9", port);
  scada.send(kRequest.data(), kRequest.size());
  for (std::size_t missing = kAnswer; missing != 0;) {
    wait_for(scada, POLLIN);
    missing -= std::min(missing, scada.receive());
    if (scada.lost() || Clock::now() - begun > kPatience) {
      throw std::runtime_error("a client that may write got no answer");
    }
  }
  const auto took = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begun).count();
  std::printf("%s %lld\n", refused ? "refused" : "taken", static_cast<long long>(took));
}

void deaf(std::uint16_t port, seconds time) {
  Socket socket("127.0.0.1", port, 4096);
  const Clock::time_point end = Clock::now() + time;
  std::size_t sent = 0;  // bytes
  while (Clock::now() < end) {
    pollfd waiting{socket.descriptor(), POLLOUT, 0};
    ::poll(&waiting, 1, 100);
    const std::size_t begun = sent % kRequest.size();
    sent += socket.send(&kRequest.at(begun), kRequest.size() - begun);
    if (socket.lost()) {
      throw std::runtime_error("a client that did not read was ended");
    }
  }
  const std::size_t asked = sent / kRequest.size();
  std::size_t received = 0;
  for (const auto last = Clock::now() + seconds(20); received < asked * kAnswer && Clock::now() < last;) {
    wait_for(socket, POLLIN);
    received += socket.receive();
    if (socket.lost()) {
      throw std::runtime_error("a client lost its answers");
    }
  }
  std::printf("%zu %zu\n", asked, received / kAnswer);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string_view> words(argv + 1, argv + argc);
  try {
    const auto port = static_cast<std::uint16_t>(std::stoi(std::string(words.at(1))));
    const auto time = [&words] { return seconds(std::stoi(std::string(words.at(2)))); };
    if (words.front() == "poll") {
      poll(port, time());
    } else if (words.front() == "full") {
      full(port);
    } else if (words.front() == "deaf") {
      deaf(port, time());
    } else {
      throw std::invalid_argument("poll, full or deaf");
    }
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "modbus_crowd: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
