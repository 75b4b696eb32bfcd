#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <semaphore>
#include <set>
#include <string>
#include <vector>

#include "bridges/mqtt/backoff.h"
#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/client.h"
#include "bridges/mqtt/loop_post.h"
#include "bridges/mqtt/outbox.h"
#include "bridges/mqtt/resolve.h"
#include "config/model.h"

namespace mqtt {

/// How the publisher behaves; the defaults are for real plants.
struct PublisherSettings {
  config::Endpoint broker;
  ClientSettings client;  ///< Its uri and version are filled in per attempt.
  int version = 0;        ///< 5 or 4 (MQTT 3.1.1) only; 0: 5, and 3.1.1 with brokers that do not speak it.
  std::chrono::milliseconds first_pause{1000};
  std::chrono::milliseconds longest_pause{5000};
  std::chrono::milliseconds pause_after_refusal{60000};  ///< Of credentials, and after a take-over of our client id.
  std::chrono::milliseconds farewell{2000};              ///< For the last messages at the end.
  std::chrono::milliseconds resolve_patience{300000};    ///< A thread that resolves longer stands still.
  Resolver resolver = resolve;
};

/// The publisher's thread: connects, sends what the loop gave it, connects again. It alone calls Paho. Messages, orders
/// and the state of the connection are behind one lock, which is never held while Paho is called, since Paho's threads
/// take it while they hold Paho's own.
class BrokerThread final : private ClientEvents {
 public:
  using Clock = std::chrono::steady_clock;

  BrokerThread(PublisherSettings settings, std::shared_ptr<LoopPost> loop);

  // From the loop.
  void publish(std::vector<Message> batch);
  void subscribe(ConnectionId connection, std::vector<Subscription> subscriptions);
  void unsubscribe(ConnectionId connection, std::vector<std::string> filters);
  void open(ConnectionId connection);
  void drop(ConnectionId connection, std::string why);
  void suspect_takeover(ConnectionId connection);
  /// Only what waits and `last` are still sent, for as long as `patience`. Without last words the broker is made to
  /// publish the will.
  void finish(std::vector<Message> last, std::chrono::milliseconds patience);
  [[nodiscard]] BrokerCounts counts() const;
  [[nodiscard]] bool alive() const;
  [[nodiscard]] const PublisherSettings& settings() const noexcept { return settings_; }

  /// The thread's work; posts Ended and returns after finish().
  void run();
  /// True when run() returned within `limit`. Waits; once.
  [[nodiscard]] bool await_end(std::chrono::milliseconds limit) { return ended_.try_acquire_for(limit); }

 private:
  enum class Link : std::uint8_t { none, connecting, up, refused, down };
  struct End {
    std::string why;
    bool stays = false;  ///< Trying again at once is of no use.
  };
  struct Order {
    ConnectionId connection = 0;
    Subscription subscription;
    bool ends = false;  ///< The subscription to this filter.
  };
  using Lock = std::unique_lock<std::mutex>;

  // From Paho's threads.
  void on_up(BrokerLimits limits) noexcept override;
  void on_refused(Refusal refusal) noexcept override;
  void on_down(int code) noexcept override;
  void on_incoming(Incoming&& message) noexcept override;
  void on_sent(const Message* message, Delivery delivery, int code) noexcept override;
  void on_subscribed(Subscribed&& subscribed) noexcept override;

  // The thread's own.
  End attempt();
  std::string next_address();
  std::optional<Refusal> connect(const std::string& address, int version);
  std::optional<Refusal> connect_by_any_version(const std::string& address);
  End serve();
  [[nodiscard]] bool carry_out(Lock& lock, std::vector<Order> orders);
  [[nodiscard]] bool send(Lock& lock);
  void drop_client();
  bool pause(std::chrono::milliseconds duration);
  void say_failure(const End& end, std::chrono::milliseconds pause);

  // All of these with the lock held.
  void expect_sign_of_life(std::chrono::milliseconds allowance);
  [[nodiscard]] bool sends() const;
  [[nodiscard]] bool all_said() const;
  [[nodiscard]] bool farewell_over() const;
  [[nodiscard]] bool has_work() const;
  [[nodiscard]] bool fits(const Message& message);
  void note_watched(const Order& order);
  [[nodiscard]] End how_it_ended() const;
  void say(Level level, std::string text);

  const PublisherSettings settings_;
  const std::string broker_;  ///< `HOST:PORT`.
  const std::shared_ptr<LoopPost> loop_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  Outbox outbox_;
  std::list<Outbox::Item> in_flight_;
  std::vector<Order> orders_;
  std::vector<std::string> watched_;  ///< Filters of this connection.
  ConnectionId connection_ = 0;
  ConnectionId opened_ = 0;
  Link link_ = Link::none;
  Refusal refusal_;
  int down_code_ = -1;
  std::optional<std::string> drop_;  ///< Why this connection is to be ended.
  bool suspects_takeover_ = false;   ///< Of this connection's client id.
  bool stalled_ = false;
  BrokerLimits limits_;
  Clock::time_point progress_{};  ///< When something was acknowledged, or sent after a time of nothing.
  Clock::time_point left_{};      ///< When something left, or began to wait alone.
  Clock::time_point silent_from_ = Clock::time_point::max();  ///< Alive until then.
  bool finishing_ = false;
  bool has_last_words_ = false;
  Clock::time_point finish_by_{};
  std::uint64_t dropped_ = 0;
  std::uint64_t said_answers_ = 0;
  std::set<std::string> said_too_long_;  ///< Topics.
  std::set<int> said_refused_;           ///< Codes.

  // The thread's own, without the lock.
  std::unique_ptr<Client> client_;
  int version_ = 0;
  Backoff backoff_;
  std::vector<std::string> addresses_;
  std::size_t next_address_ = 0;
  std::map<std::string, int> closes_;  ///< By address: how often in a row it closed instead of a CONNACK to MQTT 5.
  std::string last_failure_;
  std::binary_semaphore ended_{0};
};

}  // namespace mqtt
