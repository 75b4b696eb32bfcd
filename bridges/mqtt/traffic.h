#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/connection.h"
#include "bridges/mqtt/loop_post.h"
#include "bridges/mqtt/outbox.h"

namespace mqtt {

/// What the loop, the publisher's thread and Paho's threads share: messages, orders and the state of the connection,
/// behind one lock. Nobody calls Paho while holding it, since Paho's threads take it while they hold Paho's own.
class Traffic final : public ConnectionEvents {
 public:
  using Clock = std::chrono::steady_clock;

  /// What the publisher's thread has to do next.
  struct Work {
    std::optional<std::string> over;  ///< The connection is of no more use: why.
    std::vector<std::vector<Subscription>> subscriptions;
    std::vector<std::string> unsubscriptions;
    std::vector<std::pair<Message, InFlight*>> messages;
    bool farewell = false;  ///< Everything at the end was said, or cannot be said.
    bool all_said = false;  ///< With farewell: the last words have arrived.
  };

  /// `outbox_limit`: messages of each kind.
  Traffic(std::size_t outbox_limit, std::shared_ptr<LoopPost> loop);

  // From the loop.
  void publish(std::vector<Message> batch);
  void subscribe(ConnectionId connection, std::vector<Subscription> subscriptions);
  void unsubscribe(ConnectionId connection, std::string filter);
  void open(ConnectionId connection);
  [[nodiscard]] BrokerCounts counts();
  /// Only the newest of each topic and `last` are still sent, for as long as `patience`. Without last words the broker
  /// is made to publish the will.
  void finish(std::vector<Message> last, std::chrono::milliseconds patience);

  // From the publisher's thread.
  /// A new connection is tried; nothing when finish() was called.
  [[nodiscard]] std::optional<ConnectionId> begin();
  /// Nothing when it stands; else the code of on_refused().
  [[nodiscard]] std::optional<int> await_connection(std::chrono::milliseconds patience);
  [[nodiscard]] Work await_work();
  /// These could not be handed to Paho.
  void unfit(const InFlight* message);
  void broken();
  /// The connection is gone, Paho's client too: answers that were under way wait again.
  void end();
  /// False when finish() was called meanwhile.
  bool pause(std::chrono::milliseconds duration);
  [[nodiscard]] bool finishing();

  // From Paho's threads.
  void on_up(BrokerLimits limits) noexcept override;
  void on_refused(int code) noexcept override;
  void on_down() noexcept override;
  void on_incoming(Incoming&& message) noexcept override;
  void on_sent(const InFlight* message, Delivery delivery) noexcept override;
  void on_subscribed(Subscribed&& subscribed) noexcept override;

 private:
  enum class Link : std::uint8_t { none, connecting, up, refused, down };
  struct Ordered {
    ConnectionId connection;
    std::vector<Subscription> subscriptions;
  };

  [[nodiscard]] bool sends() const;
  [[nodiscard]] bool all_said() const;
  [[nodiscard]] bool farewell_over() const;
  [[nodiscard]] bool has_work() const;
  void take_messages(Work& work);
  void erase(const InFlight* message);

  const std::shared_ptr<LoopPost> loop_;
  std::mutex mutex_;
  std::condition_variable wake_;
  Outbox outbox_;
  std::vector<Ordered> orders_;
  std::vector<std::pair<ConnectionId, std::string>> unsubscriptions_;
  ConnectionId connection_ = 0;
  ConnectionId opened_ = 0;
  Link link_ = Link::none;
  int refusal_ = 0;
  BrokerLimits limits_;
  std::list<InFlight> in_flight_;
  Clock::time_point progress_{};  ///< When something was acknowledged, or sent after a time of nothing.
  bool finishing_ = false;
  bool has_last_words_ = false;
  Clock::time_point finish_by_{};
  bool said_too_long_ = false;
  bool said_refused_ = false;
  std::uint64_t dropped_ = 0;
  std::uint64_t said_lost_ = 0;  ///< Answers.
};

}  // namespace mqtt
