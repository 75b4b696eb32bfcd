#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <memory>
#include <thread>
#include <vector>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/broker_thread.h"
#include "bridges/mqtt/loop_post.h"
#include "bridges/mqtt/notice.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace mqtt {

/// The real broker: Paho, in a thread of its own that the loop never waits for. What the threads share they own
/// together, so that a thread that hangs in name resolution at the end is left to itself.
class Publisher final : public Broker {
 public:
  /// Longest time stop() and the destructor take.
  static constexpr canopen::Duration kStopLimit = std::chrono::seconds(5);

  Publisher(boost::asio::any_io_executor executor, PublisherSettings settings, Notice notice);
  ~Publisher() override;
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  void start(BrokerEvents& events) override;
  void subscribe(ConnectionId connection, std::vector<Subscription> subscriptions) override;
  void unsubscribe(ConnectionId connection, std::vector<std::string> filters) override;
  void publish(std::vector<Message> batch) override;
  void open(ConnectionId connection) override;
  void drop(ConnectionId connection, std::string why) override;
  void suspect_takeover(ConnectionId connection) override;
  [[nodiscard]] BrokerCounts counts() const override;
  [[nodiscard]] bool alive() const override;
  boost::asio::awaitable<void> stop(std::vector<Message> last) override;

 private:
  void receive(LoopEvent& event);
  void leave();

  Notice notice_;
  BrokerEvents* events_ = nullptr;
  std::shared_ptr<LoopPost> loop_;
  std::shared_ptr<BrokerThread> broker_thread_;
  std::thread thread_;
  canopen::Timer ended_timer_;  ///< Cancelled when the thread ended.
  bool ended_ = false;
};

/// As a site configured it. The client id is `canopen-gateway-<name>` where it names none.
[[nodiscard]] PublisherSettings publisher_settings(const config::Mqtt& mqtt, const config::Gateway& gateway);
[[nodiscard]] std::unique_ptr<Broker> make_publisher(boost::asio::any_io_executor executor, const config::Mqtt& mqtt,
                                                     const config::Gateway& gateway, Notice notice);

}  // namespace mqtt
