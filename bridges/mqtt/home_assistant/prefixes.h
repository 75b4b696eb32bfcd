#pragma once

#include <chrono>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/mqtt/message.h"
#include "bridges/mqtt/topics.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace mqtt::home_assistant {

/// Below which discovery prefixes a broker may keep messages of ours. The broker itself keeps that, beside them, on
/// Topics::home_assistant(): it is there before the first of them, of each broker by itself, and short enough to be
/// sent to us however large the site is. A prefix that is no more in use stays in it until a connection has shown that
/// nothing of ours is below it: also where the program ends before all was emptied.
class Prefixes {
 public:
  static constexpr std::size_t kMost = 16;
  /// What a broker keeps below a prefix has come by then.
  static constexpr canopen::Duration kPatience = std::chrono::seconds(10);

  /// Both outlive it.
  Prefixes(const config::Mqtt& settings, const Topics& topics);

  /// A new connection, to this broker.
  void connected(const std::string& broker);
  /// What the broker keeps on Topics::home_assistant(), whatever it is.
  void read(std::string_view kept);
  /// All, the one in use too.
  [[nodiscard]] const std::set<std::string>& all() const noexcept { return here_->prefixes; }
  /// The broker sends what it keeps below this one, on this connection.
  void granted(const std::string& prefix) { granted_.insert(prefix); }
  /// Something of ours is kept there.
  void found(const std::string& prefix) { found_.insert(prefix); }
  /// Another gateway of our name lives: nothing that this connection shows counts.
  void keep_all() { found_ = all(); }
  void announced(canopen::TimePoint now);
  /// When to come to collect().
  [[nodiscard]] canopen::TimePoint next() const noexcept { return due_; }
  void collect(canopen::TimePoint now, std::vector<Message>& out);

 private:
  struct Place {
    std::set<std::string> prefixes{};
    bool kept = false;  ///< The broker keeps a list.
  };

  const config::Mqtt& settings_;
  const Topics& topics_;
  std::map<std::string, Place> places_;  ///< By broker.
  Place* here_ = nullptr;                ///< Of this connection.
  std::set<std::string> granted_;        ///< On this connection.
  std::set<std::string> found_;          ///< On this connection.
  canopen::TimePoint announced_{};
  canopen::TimePoint due_ = canopen::kNever;
  bool said_ = false;  ///< On this connection.
};

/// Of a payload of Topics::home_assistant(), whatever the bytes are.
[[nodiscard]] std::vector<std::string> read_kept_prefixes(std::string_view kept);

}  // namespace mqtt::home_assistant
