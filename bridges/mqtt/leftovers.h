#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridges/mqtt/message.h"
#include "bridges/mqtt/notice.h"
#include "bridges/mqtt/topics.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace mqtt {

/// What stands retained below the gateway's own `B` and is published by nobody any more: topics of drives that were
/// renamed or removed, of signals that are gone, of kinds that were switched off. Hears what the broker kept, and what
/// the plant had until it changed, and says which topics are to be emptied and when. Whatever has another form than
/// ours, or lies below a name that never was a drive, is left alone.
class Leftovers {
 public:
  /// More of them are found at the next start.
  static constexpr std::size_t kMost = 10'000;

  /// An own connection that stood for so long after something was emptied has brought that to the broker.
  static constexpr canopen::Duration kArrives = std::chrono::minutes(1);

  /// `settings` and `topics` outlive it.
  Leftovers(const config::Model& model, const config::Mqtt& settings, const Topics& topics);

  /// A new connection, to this place_of(): what was found at another broker waits for the next one to that.
  void connected(const std::string& place);
  /// A message of Topics::tree_subscription(); those that the broker did not keep are ignored.
  void heard(const Incoming& message);
  /// A topic of ours outside of the tree, kept by the broker and not published.
  void found(const std::string& topic, canopen::TimePoint now);
  /// The plant and the topics changed.
  void change(const config::Model& model, canopen::TimePoint now);
  /// Nobody publishes on it any more, where we did until now; at whatever broker. To be emptied.
  void gone(const std::string& topic, canopen::TimePoint now);
  /// We publish on it, again perhaps.
  void back(const std::string& topic);
  /// The connection ended. What was emptied just before is emptied again on the next one to that place.
  void lost(canopen::TimePoint now);
  /// All that we publish was published, `online` last, on a new connection.
  void announced(canopen::TimePoint now);
  /// Until when another gateway of our name that lives would have been heard on a connection that begins now.
  [[nodiscard]] canopen::TimePoint settled(canopen::TimePoint now) const noexcept {
    return here_->in_use ? now + patience_ : now;
  }
  /// When to come to collect().
  [[nodiscard]] canopen::TimePoint next() const noexcept { return due_; }
  /// Appends what empties them where it is time, and names each. Where another gateway of this name lives, nothing of
  /// what was found is emptied, now or later.
  void collect(bool another_lives, canopen::TimePoint now, std::vector<Message>& out, const Notice& notice);

 private:
  void note_published(const config::Model& model);
  void come(canopen::TimePoint now);

  const config::Mqtt& settings_;
  const Topics& topics_;
  canopen::Duration patience_;
  std::set<std::string, std::less<>> published_;  ///< All that we publish retained of drives and buses.
  std::set<std::string, std::less<>> drives_;     ///< Names that are drives, or were: they have a status or alarms.
  /// What a broker keeps.
  struct Found {
    std::map<std::string, std::string> kept{};     ///< Of our forms, and not published: the drive; empty: no drive's.
    std::map<std::string, std::string> emptied{};  ///< On this connection, likewise.
    canopen::TimePoint emptied_at{};
    bool in_use = false;  ///< `B/status` is kept as `online`: our last life ended without a word, or another one lives.
  };
  std::map<std::string, Found> places_;  ///< By place.
  Found* here_ = &places_[{}];           ///< Of this connection.
  canopen::TimePoint due_ = canopen::kNever;
  std::optional<canopen::TimePoint> announced_;  ///< When, on this connection.
};

}  // namespace mqtt
