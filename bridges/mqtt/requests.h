#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "bridges/mqtt/answers.h"
#include "bridges/mqtt/asked.h"
#include "bridges/mqtt/message.h"
#include "bridges/mqtt/stop_signs.h"
#include "bridges/mqtt/topics.h"
#include "bridges/process/plant.h"
#include "bridges/process/plant_change.h"
#include "bridges/process/writer.h"

namespace mqtt {

struct Asker;
struct UnderWay;

/// Whoever publishes commands: one writer.
[[nodiscard]] process::Writer mqtt_writer();

/// Commands that came from the broker: what must not be carried out is answered at once, the rest goes to its drive,
/// and each is answered when the drive's outcome is there. In this order: retained, forbidden, expired, duplicate, all
/// else. Commands to one drive begin in the order of their arrival
/// and wait for each other only where the drive makes them. A stop is never a repetition, nor one too many.
class Requests {
 public:
  using Publish = std::function<void(Message)>;

  /// Commands of one drive under way at a time; further ones, but for stops, are answered `timeout` at once and not
  /// carried out.
  static constexpr std::size_t kMaxCommands = 64;
  /// SDO reads likewise, counted apart: a command must not fail because of them.
  static constexpr std::size_t kMaxReads = 64;

  /// `plant` and `topics` outlive it; `publish` is called on the loop until the end of stop().
  Requests(boost::asio::any_io_executor executor, process::Plant& plant, const Topics& topics, Publish publish);

  /// A message of one of Topics::command_subscriptions(), and what its topic is.
  void handle(const Incoming& incoming, const Route& route);

  /// A message that comes while the broker is being left: a stop is carried out, a sign of life counts; any other
  /// command is refused, for what it asks might be done while nobody sees it.
  void come_too_late(const Incoming& incoming);

  /// The plant's configuration is another one, and so are the topics. What was asked before is still answered.
  void change(const process::PlantChange& change);

  /// It stops a drive that may be stopped this way, or all. From any thread, see StopSigns.
  [[nodiscard]] bool is_stop(const Incoming& incoming) const { return stop_signs_.is_stop(incoming); }

  /// No command is under way. Reads may be: they move nothing, and their answers go along to the next broker.
  [[nodiscard]] bool is_idle() const noexcept;

  /// Takes no more commands and waits for those under way, `patience` at most: whoever is left then ends with its
  /// drive, unanswered. The plant outlives them: it is stopped after this.
  boost::asio::awaitable<void> stop(canopen::Duration patience);

 private:
  /// A command taken apart.
  struct Command {
    ReplyTo to;
    process::Drive* drive = nullptr;
    bool has_id = false;
    std::string id;  ///< For the journal and the log.
    process::CommandRecord::Kind kind = process::CommandRecord::Kind::write;
    bool reads = false;
    bool stops = false;
    bool allowed = true;  ///< MQTT may write this drive, or nothing is written.
    bool expired = false;
    canopen::Result<Asked> asked;
  };

  [[nodiscard]] Command take_apart(const Incoming& incoming, const Route& route) const;
  [[nodiscard]] ReplyTo reply_to(const Incoming& incoming, const Route& route, const process::Drive* drive) const;
  /// What is told before anything else about the command.
  [[nodiscard]] std::optional<canopen::Error> refuse_sender(const Incoming& incoming, const Command& command) const;
  /// It may be a repetition of an earlier one, and a later one a repetition of it.
  [[nodiscard]] static bool may_repeat(const Incoming& incoming, const Command& command);
  /// What is told of a command that is refused here; where it names a drive, that one notes it, and
  /// each of them where it is a stop for all.
  [[nodiscard]] process::Outcome refuse(const Incoming& incoming, const Command& command, canopen::Error mistake);
  [[nodiscard]] canopen::Result<void> begin(const Incoming& incoming, Command& command, const Asker& asker);
  /// `refusal`: of all but stops.
  void take(const Incoming& incoming, const Route& route, const std::optional<canopen::Error>& refusal);
  void take_sign_of_life(const Incoming& incoming, const Route& route);

  boost::asio::any_io_executor executor_;
  process::Plant& plant_;
  const Topics& topics_;
  StopSigns stop_signs_;
  std::shared_ptr<UnderWay> under_way_;
};

}  // namespace mqtt
