#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/notice.h"
#include "bridges/mqtt/topics.h"
#include "canopen/clock.h"

namespace mqtt {

/// What a new connection goes through before the gateway is `online`: at the first one to each broker look through what
/// is kept below `B`; subscribe to commands; then to what others write on topics of ours; then announce everything. An
/// answer that does not come holds nothing up for long. A subscription that is refused is tried again for as long as
/// the connection stands; one that is not answered kTries times is a reason to begin with another connection. Some
/// brokers refuse by closing: what the connection broke at twice in a row is left out at that broker, unless it brings
/// commands. The look is left out after kLookBreaks connections that broke during it, granted or not: what is kept
/// there may be what breaks them.
///
/// Nothing that comes by the first look is a command, unless it stops a motor: it is given back, and the broker has
/// said so, before commands are subscribed to, so that none comes twice.
class Session {
 public:
  /// Longest wait for the answer to a subscription, and for what the broker keeps.
  static constexpr canopen::Duration kSubscribePatience = std::chrono::seconds(10);
  /// All that the broker keeps has come when nothing has come for so long.
  static constexpr canopen::Duration kQuiet = std::chrono::milliseconds(500);
  /// Pauses before a subscription is tried again double from the one to the other.
  static constexpr canopen::Duration kFirstPause = std::chrono::seconds(1);
  static constexpr canopen::Duration kLongestPause = std::chrono::seconds(5);
  /// So often an answer may be missing.
  static constexpr int kTries = 3;
  /// So many connections in a row may break during the look.
  static constexpr int kLookBreaks = 3;

  /// `leaving`: the look is being given back.
  enum class Phase : std::uint8_t { offline, looking, leaving, subscribing, watching, ready };

  /// `broker` and `topics` outlive the session.
  Session(Broker& broker, const Topics& topics, Notice notice)
      : broker_(broker), topics_(topics), notice_(std::move(notice)) {}

  /// What is watched beside the gateway's own topics, from the next connection on, or the end of its look.
  void watch_too(std::vector<Subscription> subscriptions) { watched_too_ = std::move(subscriptions); }
  void connected(const Connected& connection, canopen::TimePoint now);
  void lost();
  void subscribed(const Subscribed& answer, canopen::TimePoint now);
  void unsubscribed(canopen::TimePoint now);
  /// A message came. True: by the first look, or on a connection that is given up; so it is no command but a stop,
  /// and nobody wrote it to be put right.
  [[nodiscard]] bool sets_aside(const Incoming& message, canopen::TimePoint now);
  /// A message came on a topic that is not subscribed to.
  void stray(const Incoming& message);
  /// Time passed.
  void tick(canopen::TimePoint now);

  [[nodiscard]] Phase phase() const noexcept { return phase_; }
  [[nodiscard]] bool ready() const noexcept { return phase_ == Phase::ready; }
  [[nodiscard]] ConnectionId connection() const noexcept { return connection_; }
  /// When tick() has something to do; max(): never.
  [[nodiscard]] canopen::TimePoint deadline() const noexcept;
  /// Filters whose subscription does not stand on this connection, as far as is known.
  [[nodiscard]] std::vector<std::string> refused() const;

 private:
  struct Entry {
    enum class State : std::uint8_t { asked, granted, refused };
    Subscription subscription;
    State state = State::asked;
    canopen::TimePoint at{};                ///< Asked: longest wait for the answer. Refused: when it is tried again.
    canopen::Duration pause = kFirstPause;  ///< The next one.
    int unanswered = 0;                     ///< Times in a row.
  };

  /// What was found out about a broker.
  struct Place {
    bool looked = false;             ///< It was looked through, or does not allow it.
    std::string suspect;             ///< Filter at which the last connection broke; empty: at none.
    int look_breaks = 0;             ///< Connections that broke during the look; each was the one after the other.
    std::set<std::string> left_out;  ///< Filters.
  };

  void ask(Phase phase, std::vector<Subscription> subscriptions, canopen::TimePoint now);
  void leave(canopen::TimePoint now);
  void ask_watched(canopen::TimePoint now);
  void give_up(std::string why);
  void leave_out(const std::string& filter, const std::string& times);
  /// The filter that may be why the connection breaks; empty: none.
  [[nodiscard]] std::string unanswered() const;
  void say_no_look(const std::string& why);
  void refuse(Entry& entry, const std::string& why, canopen::TimePoint now);
  void finish(canopen::TimePoint now);

  Broker& broker_;
  const Topics& topics_;
  Notice notice_;
  std::vector<Subscription> watched_too_;
  ConnectionId connection_ = 0;
  std::map<std::string, Place> places_;  ///< By place_of().
  Place* place_ = nullptr;               ///< Of this connection.
  Phase phase_ = Phase::offline;
  std::vector<Entry> entries_;  ///< Of this connection.
  std::set<std::string> said_;  ///< Filters whose refusal is on the log, until they are granted.
  bool looked_here_ = false;    ///< On this connection.
  bool answered_ = false;       ///< The subscription of the look.
  canopen::TimePoint quiet_at_{};
  canopen::TimePoint look_until_{};  ///< At the longest; then, until it must be given back.
};

}  // namespace mqtt
