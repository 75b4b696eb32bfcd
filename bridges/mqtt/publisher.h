#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/candidate.h"
#include "bridges/mqtt/client.h"
#include "bridges/mqtt/event_gate.h"
#include "bridges/mqtt/homecoming.h"
#include "bridges/mqtt/line.h"
#include "bridges/mqtt/loop_post.h"
#include "bridges/mqtt/notice.h"
#include "bridges/mqtt/pulse.h"
#include "bridges/mqtt/reach.h"
#include "bridges/mqtt/rotation.h"
#include "bridges/mqtt/traffic.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace mqtt {

/// How the publisher behaves; the defaults are for real plants.
struct PublisherSettings {
  std::vector<config::Endpoint> brokers;  ///< In the order in which they are tried; at least one.
  ClientSettings client;                  ///< Its uri, version and password are filled in per attempt.
  std::string password_file{};            ///< Path; its first line, read at each attempt. Empty: no password.
  std::string
      pulse_filter{};  ///< Nobody ever subscribes to it: to end that subscription asks whether the broker lives.
  int version = 0;     ///< 5 or 4 (MQTT 3.1.1) only; 0: 5, and 3.1.1 with brokers that do not speak it.
  std::chrono::milliseconds first_pause{1000};
  std::chrono::milliseconds longest_pause{5000};
  std::chrono::milliseconds pause_after_refusal{60000};  ///< Of credentials, and after a take-over of our client id.
  std::chrono::milliseconds return_after{600000};        ///< Reachable for so long, the first broker is tried again.
  std::chrono::milliseconds look_interval{30000};        ///< So often it is looked for.
  std::chrono::milliseconds quiet{2000};  ///< A broker that says nothing for so long is asked, where there is another.
  std::chrono::milliseconds stalled = Traffic::kStalledOfSeveral;  ///< And given up where it says nothing for so long.
  std::chrono::milliseconds hurried{3000};   ///< For a broker's name, and for a connection, where there is another.
  std::chrono::milliseconds turn{5000};      ///< For all addresses of a name together, likewise.
  std::chrono::milliseconds farewell{2000};  ///< For the last messages at the end.
  std::chrono::milliseconds resolve_patience{300000};  ///< A publisher that resolves longer stands still.
  /// alive(): longest time of the thread without a sign of life; longer than the second in which it gives one.
  std::chrono::milliseconds silence{30000};
  Resolver resolver = resolve;
};

/// The real broker: Paho, served by a thread of its own that the loop never waits for: it connects, sends what the loop
/// gave it, connects again, and alone calls Paho. What the loop, that thread and Paho's own share is behind one lock,
/// which is never held while Paho is called, since Paho's threads take it while they hold Paho's own.
class Publisher final : public Broker, private ClientEvents {
 public:
  /// Longest time stop() takes.
  static constexpr canopen::Duration kStopLimit = std::chrono::seconds(5);

  Publisher(boost::asio::any_io_executor executor, PublisherSettings settings, Notice notice);
  /// Without stop() before, the broker publishes the will.
  ~Publisher() override;
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  void start(BrokerEvents& events) override;
  void subscribe(ConnectionId connection, std::vector<Subscription> subscriptions) override;
  void unsubscribe(ConnectionId connection, std::string filter) override;
  void publish(std::vector<Message> batch) override;
  void open(ConnectionId connection) override;
  void drop(ConnectionId connection, std::string why) override;
  void leave(ConnectionId connection, std::vector<Message> last) override;
  void suspect_takeover(ConnectionId connection) override;
  [[nodiscard]] BrokerCounts counts() const override;
  [[nodiscard]] bool alive() const override;
  boost::asio::awaitable<void> stop(std::vector<Message> last) override;
  [[nodiscard]] bool ended() const override;

 private:
  using Clock = std::chrono::steady_clock;
  using Guard = std::lock_guard<std::mutex>;
  using Lock = std::unique_lock<std::mutex>;

  /// Only what waits and `last` are still sent, for as long as `patience`. Without last words the will is published.
  void finish(std::vector<Message> last, std::chrono::milliseconds patience);

  // From Paho's threads.
  void on_up(BrokerLimits limits) noexcept override;
  void on_refused(Refusal refusal) noexcept override;
  void on_down(int code) noexcept override;
  void on_incoming(Incoming&& message) noexcept override;
  void on_sent(const Message* message, Delivery delivery, int code) noexcept override;
  void on_subscribed(Subscribed&& subscribed) noexcept override;
  void on_unsubscribed(const std::string& filter) noexcept override;

  /// How the turn of a broker ended.
  struct Turn {
    Line::End end;
    bool stood = false;  ///< There was a connection.
    bool held = false;   ///< For long enough to be a good one.
    std::chrono::milliseconds stood_for{};
    bool to_mend = false;  ///< There was none for a reason that is to be told.
  };

  // The thread's work: connections, in publisher_connect.cpp.
  [[nodiscard]] Turn take_turn();
  [[nodiscard]] Turn attempt(const std::string& address);
  void find_addresses();
  /// Of the other brokers, while nobody waits for them.
  void find_addresses_ahead(Clock::time_point now);
  void tell_connected(const std::string& address, int version);
  std::optional<Refusal> connect(const std::string& address, int version);
  [[nodiscard]] std::chrono::milliseconds connect_patience();
  [[nodiscard]] std::optional<Refusal> await_connection(std::chrono::milliseconds patience, int version);
  /// Somebody takes connections there.
  [[nodiscard]] bool accepts(const std::string& address);
  [[nodiscard]] std::string mistake_of_tls();
  [[nodiscard]] Candidate& candidate() { return candidates_[rotation_.at()]; }
  [[nodiscard]] bool is_one_of_several() const { return candidates_.size() > 1; }
  [[nodiscard]] bool is_finishing() const;
  /// Where this broker, or this machine of it, is none, there is another one.
  [[nodiscard]] bool has_elsewhere() { return is_one_of_several() || candidate().addresses.are_of_several(); }
  /// The next broker, or the next address, is to be in use soon: not each was tried in vain.
  [[nodiscard]] bool hurries() {
    return (is_one_of_several() || candidate().attempts.addresses() > 1) && rotation_.is_first_round();
  }

  // What it does with them, and between them.
  void run();
  Turn serve();
  [[nodiscard]] Line::End serve_until_end();
  /// Returns the time then: there is work, or it is time to look at what nobody calls for.
  Clock::time_point wait_for_work(Lock& lock);
  [[nodiscard]] bool is_silent(Clock::time_point now);
  /// When is_silent() or look_home() has something to do.
  [[nodiscard]] Clock::time_point check_at(Clock::time_point now);
  void look_home(Clock::time_point now);
  void begin_look(Homecoming::Step step);
  /// The loop is to know whether the broker in use may be left.
  void tell_may_leave(bool may);
  [[nodiscard]] bool carry_out(Lock& lock);
  [[nodiscard]] bool send(Lock& lock);
  void drop_client();
  [[nodiscard]] std::chrono::milliseconds turn_to_next(const Turn& turn);
  [[nodiscard]] bool pause(std::chrono::milliseconds duration);
  void say_end(Candidate& ended, const Turn& turn, std::chrono::milliseconds pause);
  /// With the name of the broker, where there are several.
  [[nodiscard]] std::string named(const Candidate& which, const std::string& why) const;

  // With the lock held.
  void expect_sign_of_life(std::chrono::milliseconds allowance, Clock::time_point now = Clock::now()) {
    silent_from_ = now + allowance;
  }
  [[nodiscard]] bool farewell_over(Clock::time_point now);
  [[nodiscard]] bool has_work(Clock::time_point now);
  void wake_if_needed(Lock lock, Clock::time_point now);

  void say(Level level, std::string text);

  const PublisherSettings settings_;
  const Notice notice_;
  BrokerEvents* events_ = nullptr;
  const std::shared_ptr<LoopPost> loop_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  Line line_;
  Pulse pulse_;
  mutable Traffic traffic_;                                   ///< What waited for too long goes when it is looked at.
  Clock::time_point silent_from_ = Clock::time_point::max();  ///< Alive until then.
  bool finishing_ = false;
  bool has_last_words_ = false;
  bool thread_ends_ = false;  ///< It waits for nothing any more.
  Clock::time_point finish_by_{};

  // The thread's own, without the lock.
  std::unique_ptr<EventGate> gate_;  ///< Of the client.
  std::unique_ptr<Client> client_;
  std::vector<Candidate> candidates_;
  Rotation rotation_;
  Homecoming homecoming_;
  Errand<Reach> look_;                                    ///< For the first broker, from another one.
  bool look_tries_ = false;                               ///< It is a connection on trial.
  Clock::time_point turn_by_ = Clock::time_point::max();  ///< Then the next broker has its turn.

  // The loop's own.
  std::thread thread_;
  canopen::Timer ended_timer_;  ///< Cancelled when the thread has ended.
  bool ended_ = false;
};

/// As a site configured it. The client id is `canopen-gateway-<name>` where it names none.
[[nodiscard]] PublisherSettings publisher_settings(const config::Mqtt& mqtt, const config::Gateway& gateway);

}  // namespace mqtt
