#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridges/mqtt/alarm_topics.h"
#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/feed.h"
#include "bridges/mqtt/health_topic.h"
#include "bridges/mqtt/home_assistant/discovery.h"
#include "bridges/mqtt/leftovers.h"
#include "bridges/mqtt/notice.h"
#include "bridges/mqtt/other_gateway.h"
#include "bridges/mqtt/put_right_tally.h"
#include "bridges/mqtt/requests.h"
#include "bridges/mqtt/session.h"
#include "bridges/mqtt/status_topic.h"
#include "bridges/mqtt/topics.h"
#include "bridges/process/health.h"
#include "bridges/process/observer.h"
#include "bridges/process/plant.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace mqtt {

/// The plant on MQTT: marks what changed as the plant tells it, gives the broker one batch per turn of the loop at
/// most, and takes commands. One loop, one thread.
class Bridge final : public process::Observer, private BrokerEvents {
 public:
  /// To be added to the plant's observers before Plant::start(). The plant outlives it. `version` is shown in `B/info`;
  /// `instance` too, it is new at each start of the program. Drives and buses may change; other settings, and the name
  /// of the gateway, need another bridge.
  Bridge(boost::asio::any_io_executor executor, process::Plant& plant, const config::Mqtt& settings,
         const config::Gateway& gateway, std::string version, std::string instance, std::unique_ptr<Broker> broker,
         Notice notice);
  ~Bridge();
  Bridge(const Bridge&) = delete;
  Bridge& operator=(const Bridge&) = delete;

  void start();
  /// Waits for commands under way, says that no value is live, and `offline` of every drive and of the gateway, and
  /// disconnects; within a few seconds, whatever the broker does. Before Plant::stop().
  boost::asio::awaitable<void> stop();

  /// Connected to the broker, and everything was published once.
  [[nodiscard]] bool connected() const noexcept { return session_.ready(); }
  /// False: the way to the broker stands still, and only a new start of the program helps.
  [[nodiscard]] bool alive() const { return broker_->alive(); }
  /// After stop(): it may go. A thread that stands still would keep the destructor waiting.
  [[nodiscard]] bool ended() const { return broker_->ended(); }
  /// Called on the loop whenever connected() changes.
  void on_connected_change(std::function<void(bool)> function) { connected_change_ = std::move(function); }

  /// Gives what `B/health` tells of the program; called on the loop. Without it that part is empty.
  void tell_program_health_by(std::function<process::ProgramHealth()> function) {
    program_health_ = std::move(function);
  }
  [[nodiscard]] process::BrokerHealth broker_health() const;
  [[nodiscard]] BrokerCounts broker_counts() const { return broker_->counts(); }

  void on_values(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_freshness(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_commanded(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_control(const process::Drive& drive) override;
  void on_status(const process::Drive& drive) override;
  void on_alarm(const process::Drive& drive, alarms::AlarmKind kind) override;
  void on_bus(std::size_t bus) override;
  void on_bus_alarm(std::size_t bus) override;
  void on_plant_change(const process::PlantChange& change) override;

 private:
  void on_connected(const Connected& connection) override;
  void on_taken_over() override;
  void on_no_connection(const std::string& why) override { last_break_ = why; }
  void on_may_leave(ConnectionId connection, bool may) override;
  void on_disconnected(const std::string& why) override;
  void on_subscribed(const Subscribed& subscribed) override;
  void on_unsubscribed(const std::string& filter) override;
  void on_message(Incoming message) override;
  [[nodiscard]] bool is_stop(const Incoming& message) const override { return requests_.is_stop(message); }

  boost::asio::awaitable<void> run();
  /// Publishes what is due; returns when to come again.
  canopen::TimePoint turn();
  void announce();
  [[nodiscard]] Message info() const;
  /// Of drives that left and whose name nobody has now: nothing of them is live any more.
  void say_last_of_gone(const process::PlantChange& change);
  /// The topics that are put right where others write there are due whatever they say.
  void tell_again();
  void collect(canopen::TimePoint now);
  void send_batch(canopen::TimePoint now);
  /// A message of the look, or on a connection that is given up.
  void looked_at(const Incoming& message);
  /// A message that is not on our tree.
  void elsewhere(const Incoming& message);
  /// What an orderly end says, behind all that waits here.
  [[nodiscard]] std::vector<Message> last_words();
  /// This broker for the first one, as soon as nothing suffers by it; returns when to look again.
  canopen::TimePoint leave_if_ready(canopen::TimePoint now);
  void leave();
  /// Drives that a command timeout would stop or change if MQTT fell silent for a moment, for people; empty: none.
  [[nodiscard]] std::string drives_that_count_on_mqtt() const;
  /// Somebody published on the topic of a status.
  void status_received(const Incoming& message, const Route& route);
  void health_may_differ();
  void follow_session();
  /// Something that waits for no company is due then.
  void wake(canopen::TimePoint at);
  void come_again(canopen::TimePoint at);
  void publish(Message message);

  process::Plant& plant_;
  config::Mqtt settings_;  ///< Its own: the model that it came from may go.
  std::string version_;
  std::unique_ptr<Broker> broker_;
  Notice notice_;
  Topics topics_;
  Session session_;
  Requests requests_;
  AlarmTopics alarms_;
  StatusTopic status_;
  HealthTopic health_;
  Leftovers leftovers_;
  home_assistant::Discovery home_assistant_;
  OtherGateway other_;
  PutRightTally put_right_;
  std::vector<Feed> feeds_;       ///< By drive.
  std::vector<Message> batch_;    ///< What waits for the broker's thread.
  canopen::TimePoint next_;       ///< When something of the alarms or feeds is due.
  canopen::TimePoint sent_at_{};  ///< The last batch.
  bool urgent_ = false;           ///< The next one waits for no company.
  std::function<void(bool)> connected_change_;
  std::function<process::ProgramHealth()> program_health_;
  std::optional<Connected> connection_;
  std::string last_break_;  ///< Why the last connection ended, or none came about since.
  bool was_connected_ = false;
  bool may_leave_ = false;  ///< This broker, as soon as nothing suffers by it.
  bool leaving_ = false;    ///< The last words there are said.
  bool said_why_not_ = false;

  boost::asio::any_io_executor executor_;
  canopen::Timer timer_;
  canopen::TimePoint wake_at_;  ///< When the timer runs out.
  bool stopping_ = false;
  bool running_ = false;
  canopen::Timer ended_;  ///< Cancelled when run() ended.
};

}  // namespace mqtt
