#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/client.h"
#include "bridges/mqtt/message.h"
#include "bridges/mqtt/notice.h"
#include "bridges/mqtt/outbox.h"
#include "bridges/mqtt/suspects.h"

namespace mqtt {

/// Bytes of the PUBLISH that carries the message (MQTT 5 §3.3, 3.1.1 §3.3).
[[nodiscard]] std::size_t packet_size(const Message& message, int version, int qos);

/// What goes to the broker, over all connections: what waits, what is under way, and when the next may leave. Knows no
/// time but what it is given. Not thread-safe.
class Traffic {
 public:
  using TimePoint = Outbox::TimePoint;
  /// Nothing that was sent is acknowledged for so long, and for as long as the oldest of it takes on a line of
  /// kSlowestLine besides: the broker hangs, although TCP stands. Paho's own ping notices only after two periods of
  /// keep alive, and not while its socket is full.
  static constexpr std::chrono::seconds kStalled{8};
  /// Likewise where there is another broker, which is to be in use 10 s after this one fell silent.
  static constexpr std::chrono::seconds kStalledOfSeveral{4};
  /// Bytes a second. A long message must not end each connection over a slow line.
  static constexpr std::size_t kSlowestLine = 4000;

  Traffic(int qos, Notice notice) : qos_(qos), notice_(std::move(notice)) {}
  Traffic(const Traffic&) = delete;
  Traffic& operator=(const Traffic&) = delete;

  void push(std::vector<Message> batch, TimePoint now);
  /// A connection of this version of MQTT (5, or 4 for 3.1.1) stands. Nothing leaves before open().
  void begin(const BrokerLimits& limits, int version, TimePoint now);
  void open() noexcept { open_ = true; }
  /// It is gone. `unexplained`: perhaps because of what was under way.
  void end(bool unexplained, TimePoint now);

  /// The next connection is to this broker of the list: what another one ended connections for is nothing to it. The
  /// addresses of one name are one broker, for they have the same rules; some name servers give another one each time.
  void at_broker(std::size_t which) { suspects_ = &suspects_of_[which]; }

  [[nodiscard]] bool is_open() const noexcept { return open_; }
  /// next() has something.
  [[nodiscard]] bool may_send(TimePoint now);
  /// The next message, under way from now on, in its place in memory until acknowledged() or end(); nullptr: none may
  /// leave. Drops on the way what is too long.
  [[nodiscard]] const Message* next(TimePoint now);
  /// Paho cannot send it.
  void unfit(const Message* message);
  /// Paho took nothing any more: it did not leave.
  void not_sent(const Message* message, TimePoint now);
  /// `code`: of a PUBACK that refuses it.
  void acknowledged(const Message* message, Delivery delivery, int code, TimePoint now);

  [[nodiscard]] bool all_said(TimePoint now) { return open_ && under_way_.empty() && front(now) == nullptr; }
  /// Nothing is held back, either.
  [[nodiscard]] bool nothing_waits() const { return open_ && under_way_.empty() && outbox_.empty(); }
  /// Nothing is under way.
  [[nodiscard]] bool is_idle() const noexcept { return under_way_.empty(); }
  [[nodiscard]] bool stalled(TimePoint now, std::chrono::milliseconds patience = kStalled) const;
  /// When it becomes true if nothing is acknowledged until then; max(): nothing is under way.
  [[nodiscard]] TimePoint stalled_at(std::chrono::milliseconds patience) const;
  [[nodiscard]] BrokerCounts counts() const;

 private:
  [[nodiscard]] Outbox::Holds holds(TimePoint now) const;
  [[nodiscard]] const Message* front(TimePoint now) { return outbox_.front(now, holds(now)); }
  [[nodiscard]] std::list<Outbox::Item>::iterator find(const Message* message);
  [[nodiscard]] bool has_room() const noexcept { return open_ && under_way_.size() < limits_.window; }
  /// What is suspected leaves alone.
  [[nodiscard]] bool may_join(const Message& next) const;
  [[nodiscard]] bool fits(const Message& message);
  void say(const Suspects::Verdict& held) const;

  int qos_;
  Notice notice_;
  Outbox outbox_;
  std::list<Outbox::Item> under_way_;
  std::map<std::size_t, Suspects> suspects_of_;  ///< By broker.
  Suspects* suspects_ = &suspects_of_[0];        ///< Of this one.
  bool open_ = false;
  bool begun_ = false;  ///< What leaves after all else was acknowledged on this connection.
  int version_ = 0;
  BrokerLimits limits_;
  TimePoint progress_{};  ///< When something was acknowledged, or sent after a time of nothing.
  TimePoint left_{};      ///< When something left.
  std::uint64_t published_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t said_answers_ = 0;
  std::set<std::string> said_too_long_;  ///< Topics.
  std::set<int> said_refused_;           ///< Codes.
};

}  // namespace mqtt
