#include "tests/unit/mqtt/tiny_broker.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

namespace mqtt::test {
namespace {

constexpr int kMqtt5 = 5;
constexpr std::uint8_t kConnect = 1;
constexpr std::uint8_t kPublish = 3;
constexpr std::uint8_t kPubAck = 4;
constexpr std::uint8_t kSubscribe = 8;
constexpr std::uint8_t kUnsubscribe = 10;
constexpr std::uint8_t kPing = 12;
constexpr std::uint8_t kDisconnect = 14;

bool readable(int socket) {
  pollfd wait{socket, POLLIN, 0};
  return poll(&wait, 1, 20) > 0;
}

void send_bytes(int client, std::initializer_list<std::uint8_t> bytes) {
  const std::vector<std::uint8_t> copy(bytes);
  (void)send(client, copy.data(), copy.size(), MSG_NOSIGNAL);
}

// One packet: its first byte and what follows the length (MQTT 3.1.1 §2.2).
bool receive_exactly(int client, std::uint8_t* to, std::size_t size) {
  for (std::size_t have = 0; have < size;) {
    const ssize_t got = recv(client, to + have, size - have, 0);
    if (got <= 0) {
      return false;
    }
    have += static_cast<std::size_t>(got);
  }
  return true;
}

bool receive_packet(int client, std::uint8_t& first, std::vector<std::uint8_t>& body) {
  if (!receive_exactly(client, &first, 1)) {
    return false;
  }
  std::size_t length = 0;
  unsigned shift = 0;
  std::uint8_t byte = 0x80;
  while ((byte & 0x80U) != 0) {
    if (!receive_exactly(client, &byte, 1)) {
      return false;
    }
    length |= static_cast<std::size_t>(byte & 0x7FU) << shift;
    shift += 7;
  }
  body.resize(length);
  return receive_exactly(client, body.data(), length);
}

}  // namespace

TinyBroker::TinyBroker(Manners manners) : manners_(manners), server_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  const bool listening = bind(server_, reinterpret_cast<const sockaddr*>(&address), length) == 0 &&
                         listen(server_, 5) == 0 &&
                         getsockname(server_, reinterpret_cast<sockaddr*>(&address), &length) == 0;
  if (!listening) {
    throw std::runtime_error("no port for the broker");
  }
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { serve(); });
}

TinyBroker::~TinyBroker() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  taking_.notify_all();
  thread_.join();
  close(server_);
}

std::vector<int> TinyBroker::levels() const {
  const std::lock_guard lock(mutex_);
  return levels_;
}

std::vector<std::string> TinyBroker::published() const {
  const std::lock_guard lock(mutex_);
  return published_;
}

bool TinyBroker::take_one() {
  std::unique_lock lock(mutex_);
  const std::size_t wanted = ++may_take_;
  taking_.notify_all();
  return taking_.wait_for(lock, std::chrono::seconds(20), [&] { return published_.size() >= wanted; });
}

void TinyBroker::take_all() {
  const std::lock_guard lock(mutex_);
  may_take_ = std::numeric_limits<std::size_t>::max();
  taking_.notify_all();
}

void TinyBroker::take_by_hand() {
  const std::lock_guard lock(mutex_);
  may_take_ = published_.size();
}

void TinyBroker::deliver(const std::string& topic, const std::string& payload) const {
  const bool has_properties = level_ == kMqtt5;
  const std::size_t length = 2 + topic.size() + (has_properties ? 1 : 0) + payload.size();
  std::string packet{'\x30', static_cast<char>(length), 0, static_cast<char>(topic.size())};
  packet += topic;
  packet.append(has_properties ? 1 : 0, '\0');
  packet += payload;
  (void)send(connected_, packet.data(), packet.size(), MSG_NOSIGNAL);
}

void TinyBroker::serve() {
  while (!stopping_) {
    if (!readable(server_)) {
      continue;
    }
    const int client = accept(server_, nullptr, nullptr);
    connected_ = client;
    serve_client(client);
    close(client);
  }
}

void TinyBroker::serve_client(int client) {
  std::uint8_t first = 0;
  std::vector<std::uint8_t> body;
  while (!stopping_) {
    if (const int code = kick_.exchange(0); code != 0) {
      send_bytes(client, {0xE0, 2, static_cast<std::uint8_t>(code), 0});
      return;
    }
    if (!readable(client)) {
      continue;
    }
    if (!receive_packet(client, first, body) || !answer(client, first, body)) {
      return;
    }
  }
}

bool TinyBroker::answer(int client, std::uint8_t first, const std::vector<std::uint8_t>& body) {
  const auto type = static_cast<std::uint8_t>(first >> 4U);
  if (type == kConnect) {
    return answer_connect(client, body);
  }
  if (manners_.mute) {
    return true;
  }
  unsubscribes_ += type == kUnsubscribe ? 1 : 0;
  pings_ += type == kPing ? 1 : 0;
  if (type == kPublish) {
    return take_publish(client, first, body);
  }
  if (type == kSubscribe && manners_.closes_on_subscribe) {
    return false;
  }
  if (type == kSubscribe) {
    if (level_ == kMqtt5) {
      send_bytes(client, {0x90, 4, body[0], body[1], 0, 0});
    } else {
      send_bytes(client, {0x90, 3, body[0], body[1], 0});  // of one filter
    }
    flood(client);
  } else if (type == kUnsubscribe && level_ == kMqtt5) {
    send_bytes(client, {0xB0, 4, body[0], body[1], 0, 0});
  } else if (type == kUnsubscribe) {
    send_bytes(client, {0xB0, 2, body[0], body[1]});
  } else if (type == kPubAck && manners_.flood != 0) {
    flood_taken_.set_value();
  } else if (type == kPing) {
    send_bytes(client, {0xD0, 0});
  }
  return type != kDisconnect;
}

bool TinyBroker::answer_connect(int client, const std::vector<std::uint8_t>& body) {
  const int level = body.at(6);
  {
    const std::lock_guard lock(mutex_);
    levels_.push_back(level);
  }
  if (manners_.mute) {
    return true;
  }
  level_ = level;
  taken_ = 0;
  if (level == kMqtt5 && manners_.closes_on_5) {
    return false;
  }
  const bool wrong_version = level == kMqtt5 && !manners_.speaks_5;
  const auto code = static_cast<std::uint8_t>(wrong_version ? 1 : manners_.refusal);
  if (level == kMqtt5 && manners_.speaks_5) {
    send_bytes(client, {0x20, 3, 0, code, 0});
  } else {
    send_bytes(client, {0x20, 2, 0, code});
  }
  return code == 0;
}

// QoS 0 but for the last.
void TinyBroker::flood(int client) const {
  if (manners_.flood == 0) {
    return;
  }
  for (std::size_t i = 0; i < manners_.flood; ++i) {
    send_bytes(client, {0x30, 6, 0, 1, 'x', 'r', 'u', 'n'});
  }
  send_bytes(client, {0x32, 9, 0, 1, 'x', 0, 1, 's', 't', 'o', 'p'});
}

bool TinyBroker::take_publish(int client, std::uint8_t first, const std::vector<std::uint8_t>& body) {
  const std::size_t length = static_cast<std::size_t>(body.at(0)) << 8U | body.at(1);
  const auto topic_end = body.begin() + 2 + static_cast<std::ptrdiff_t>(length);
  std::string text(body.begin() + 2, topic_end);
  const bool says_why = levels().size() % 4 != 0;
  const bool is_fed_up = manners_.patience != 0 && ++taken_ > manners_.patience / (says_why ? 1 : 2);
  if (is_fed_up && says_why) {
    send_bytes(client, {0xE0, 2, 0x8B, 0});
  }
  if (is_fed_up || text == manners_.hates) {
    return false;
  }
  if (manners_.by_hand) {
    std::unique_lock lock(mutex_);
    taking_.wait(lock, [this] { return may_take_ > published_.size() || stopping_; });
  }
  auto payload = topic_end;
  if ((first & 0x06U) != 0) {
    send_bytes(client, {0x40, 2, *topic_end, *(topic_end + 1)});
    payload += 2;
  }
  if (level_ == kMqtt5) {
    payload += 1 + *payload;  // properties of less than 128 bytes
  }
  text += '=';
  text.append(payload, body.end());
  const std::lock_guard lock(mutex_);
  published_.push_back(std::move(text));
  taking_.notify_all();
  return true;
}

}  // namespace mqtt::test
