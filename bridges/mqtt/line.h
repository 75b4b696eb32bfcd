#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/client.h"

namespace mqtt {

/// How the connection of this moment stands, and what is asked of it.
struct Line {
  enum class State : std::uint8_t { none, connecting, up, refused, down };
  struct Order {
    Subscription subscription;
    bool ends = false;  ///< It does, instead of beginning.
  };
  /// Why there is no connection (any more).
  struct End {
    std::string why;
    bool stays = false;        ///< Trying again at once is of no use.
    bool unexplained = false;  ///< What was under way may be the reason.
    bool silent = false;       ///< The broker said nothing any more.
    bool dropped = false;      ///< From this side, for something that the broker does or does not do.
    bool left = false;         ///< For the sake of another broker.
  };

  ConnectionId connection = 0;
  State state = State::none;
  BrokerLimits limits{};
  Refusal refusal{};
  int down_code = -1;              ///< Of the DISCONNECT that the broker sent; negative: none came.
  bool suspects_takeover = false;  ///< Of the client id, by another client.
  bool stalled = false;
  std::optional<std::string> drop{};  ///< It is to be ended from this side: why.
  bool asked_to_leave = false;        ///< The loop knows that it may be left for the first broker.
  /// It is being left: when the last words are given up.
  std::optional<std::chrono::steady_clock::time_point> leave_by{};
  std::vector<Order> orders{};
  std::vector<std::string> watched{};  ///< Filters.

  /// A new attempt, and what the client tells of it.
  void begin();
  void up(const BrokerLimits& of_broker);
  void refused(const Refusal& by_broker);
  void down(int code);
  /// Nobody waits for it any more: one that comes about now is none.
  void give_up() { refused(refusal); }

  [[nodiscard]] bool is_up() const noexcept { return state == State::up; }
  /// It is up or was.
  [[nodiscard]] bool stood() const noexcept { return is_up() || state == State::down; }
  /// There is something to do but to send.
  [[nodiscard]] bool wants() const noexcept { return !is_up() || drop || !orders.empty(); }
  /// What is to be subscribed and unsubscribed now.
  [[nodiscard]] std::vector<Order> take_orders();
  /// What comes on this topic comes because it is watched.
  [[nodiscard]] bool is_watched(std::string_view topic) const;
  [[nodiscard]] End end(const std::string& client_id) const;
};

/// Why an attempt brought no connection, in words.
[[nodiscard]] std::string text_of(const Refusal& refusal);

}  // namespace mqtt
