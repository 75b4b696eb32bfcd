#include "bridges/mqtt/reach.h"

#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <string_view>

#include "bridges/mqtt/exchange.h"
#include "bridges/mqtt/reasons.h"
#include "bridges/mqtt/tcp_connection.h"

namespace mqtt {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int kLevel5 = 5;
constexpr int kLevel4 = 4;
// What there is no version of (MQTT 5 §3.1.2.2).
constexpr int kLevelOfNobody = 127;
constexpr auto kConnack = static_cast<char>(0x20);
constexpr auto kDisconnect = static_cast<char>(0xE0);
constexpr std::size_t kConnackCode = 3;  // Its place, as long as the packet is shorter than 128 bytes.

void append_text(std::string& packet, std::string_view text) {
  packet += static_cast<char>(text.size() >> 8U);
  packet += static_cast<char>(text.size() & 0xFFU);
  packet += text;
}

// CONNECT, clean start (MQTT 5 and 3.1.1 §3.1).
std::string connect_packet(int level, const std::string& id, const std::string& user, const std::string& password) {
  constexpr unsigned kClean = 0x02;
  constexpr unsigned kPassword = 0x40;
  constexpr unsigned kUser = 0x80;
  constexpr char kKeepAlive = 60;
  std::string body;
  append_text(body, "MQTT");
  body += static_cast<char>(level);
  body += static_cast<char>(kClean | (user.empty() ? 0U : kUser) | (password.empty() ? 0U : kPassword));
  body += {0, kKeepAlive};
  if (level == kLevel5) {
    body += '\0';  // no properties: the session ends with the connection
  }
  append_text(body, id);
  if (!user.empty()) {
    append_text(body, user);
  }
  if (!password.empty()) {
    append_text(body, password);
  }
  std::string packet(1, '\x10');
  std::size_t left = body.size();
  for (; left >= 0x80; left >>= 7U) {
    packet += static_cast<char>((left & 0x7FU) | 0x80U);
  }
  packet += static_cast<char>(left);
  return packet + body;
}

bool say_plain(const TcpConnection& to, const std::string& words) {
  return send(to.descriptor, words.data(), words.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(words.size());
}

Answer ask_plain(const config::Endpoint& broker, const std::vector<std::string>& addresses, const Question& question,
                 milliseconds patience) {
  const auto end = steady_clock::now() + patience;
  const TcpConnection connection = connect_to(addresses, broker.port, end);
  Answer answer;
  if (connection.descriptor < 0 || !say_plain(connection, question.words)) {
    return answer;
  }
  while (answer.words.size() < question.answer && wait_for(connection, POLLIN, end)) {
    char byte = 0;
    if (const ssize_t got = recv(connection.descriptor, &byte, 1, 0); got != 1) {
      answer.closed = got == 0 || errno == ECONNRESET;
      return answer;
    }
    answer.words += byte;
  }
  if (answer.words.size() == question.answer) {
    (void)say_plain(connection, question.goodbye);
  }
  return answer;
}

Answer ask_broker(const config::Endpoint& broker, const std::vector<std::string>& addresses, const TlsFiles& files,
                  const Question& question, milliseconds patience) {
  return broker.tls ? ask_by_tls(broker, addresses, files, question, patience)
                    : ask_plain(broker, addresses, question, patience);
}

std::string why_not(const Answer& answer) {
  if (!answer.mistake.empty()) {
    return answer.mistake;
  }
  return answer.closed ? "it closes the connection before it answers" : "no answer";
}

Manner manner_of(const Answer& answer) {
  if (!answer.mistake.empty()) {
    return Manner::unknown;
  }
  if (answer.words.empty()) {
    return answer.closed ? Manner::closes : Manner::unknown;
  }
  switch (answer.words.front()) {
    case kConnack:
      return Manner::connack;
    case kDisconnect:
      return Manner::closes;
    default:
      return Manner::foreign;
  }
}

}  // namespace

Reach reaches(const config::Endpoint& broker, const std::vector<std::string>& addresses, const TlsFiles& files,
              milliseconds patience) {
  const Answer answer =
      ask_broker(broker, addresses, files, {.words = connect_packet(kLevelOfNobody, {}, {}, {})}, patience);
  const Manner manner = manner_of(answer);
  if (manner == Manner::foreign) {
    return {.why = "what answers there is no MQTT broker", .manner = manner};
  }
  const bool lives = manner != Manner::unknown;
  return {.good = lives, .why = lives ? std::string() : why_not(answer), .manner = manner};
}

bool speaks_tls(const config::Endpoint& broker, const std::vector<std::string>& addresses, milliseconds patience) {
  // ClientHello of TLS 1.2 without extensions (RFC 5246 §7.4.1.2): version, random, session id, two cipher suites, no
  // compression. In its record (§6.2.1).
  constexpr std::size_t kRandom = 32;
  const std::string body = std::string("\x03\x03") + std::string(kRandom, 'r') + std::string(1, '\0') +
                           std::string("\x00\x04\xC0\x2F\xC0\x2B\x01\x00", 8);
  const std::string hello = std::string("\x01\x00\x00", 3) + static_cast<char>(body.size()) + body;
  const std::string record = std::string("\x16\x03\x01\x00", 4) + static_cast<char>(hello.size()) + hello;
  const Answer answer = ask_plain(broker, addresses, {.words = record}, patience);
  constexpr char kAlert = 0x15;
  constexpr char kHandshake = 0x16;
  return !answer.words.empty() && (answer.words.front() == kAlert || answer.words.front() == kHandshake);
}

Reach takes_us(const config::Endpoint& broker, const std::vector<std::string>& addresses, const ClientSettings& client,
               int version, milliseconds patience) {
  const std::string goodbye{kDisconnect, 0};
  std::string why;
  for (const int level : {kLevel5, kLevel4}) {
    if (version != 0 && version != level) {
      continue;
    }
    const Answer answer =
        ask_broker(broker, addresses, client.tls,
                   {.words = connect_packet(level, client.client_id, client.username, client.password),
                    .answer = kConnackCode + 1,
                    .goodbye = goodbye},
                   patience);
    if (answer.words.size() <= kConnackCode || answer.words.front() != kConnack) {
      why = why_not(answer);
      if (answer.closed) {
        continue;  // so do brokers that do not speak this version
      }
      break;
    }
    const int code = static_cast<std::uint8_t>(answer.words[kConnackCode]);
    if (code == 0) {
      return {.good = true};
    }
    why = reason_text(code);
    if (!refuses_version(code)) {
      break;
    }
  }
  return {.why = why};
}

}  // namespace mqtt
