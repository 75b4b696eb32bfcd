#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <functional>
#include <memory>
#include <span>

#include "bridges/mqtt/answers.h"
#include "bridges/mqtt/command.h"
#include "bridges/mqtt/duplicates.h"
#include "bridges/mqtt/message.h"
#include "bridges/mqtt/topics.h"
#include "bridges/process/plant.h"

namespace mqtt {

struct UnderWay;

/// Commands that came from the broker: what must not be carried out is answered at once, the rest goes to its drive,
/// and each is answered when the drive's outcome is there. Commands to one drive begin in the order of their arrival
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

  /// A message of one of Topics::command_subscriptions().
  void handle(const Incoming& command);

  /// Takes no more commands and waits for those under way, `patience` at most: whoever is left then ends with its
  /// drive, unanswered. The plant outlives them: it is stopped after this.
  boost::asio::awaitable<void> stop(canopen::Duration patience);

 private:
  /// A command that may be carried out as far as MQTT is concerned.
  struct Command {
    Route route;
    Parsed parsed;
    ReplyTo to;
    process::Drive* drive = nullptr;
  };

  [[nodiscard]] Command take_apart(const Incoming& incoming, const Route& route);
  [[nodiscard]] canopen::Result<void> check(const Incoming& incoming, const Command& command) const;
  /// Refuses a repetition, and one too many; never a stop.
  [[nodiscard]] canopen::Result<void> check_begin(const Incoming& incoming, const Command& command,
                                                  std::span<const process::FieldWrite> fields = {});
  [[nodiscard]] canopen::Result<void> begin(const Incoming& incoming, const Command& command);
  [[nodiscard]] canopen::Result<void> begin_set(const Incoming& incoming, const Command& command);
  [[nodiscard]] canopen::Result<void> begin_nmt(const Incoming& incoming, const Command& command);
  [[nodiscard]] canopen::Result<void> begin_sdo(const Incoming& incoming, const Command& command);
  [[nodiscard]] canopen::Result<void> begin_stop_all(const Incoming& incoming, const Command& command);
  void take_sign_of_life(const Incoming& incoming, const Route& route);
  /// Counts what is under way; `among` those of its drive, null: of no single one.
  void spawn(std::size_t* among, boost::asio::awaitable<void> work);
  [[nodiscard]] process::Drive* find_drive(std::string_view name);

  boost::asio::any_io_executor executor_;
  process::Plant& plant_;
  const Topics& topics_;
  Duplicates duplicates_;
  std::shared_ptr<UnderWay> under_way_;
};

}  // namespace mqtt
