#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "bridges/mqtt/answers.h"
#include "bridges/mqtt/asked.h"
#include "bridges/mqtt/duplicates.h"
#include "bridges/mqtt/message.h"
#include "bridges/process/command.h"
#include "bridges/process/drive.h"
#include "bridges/process/plant.h"
#include "bridges/process/plant_change.h"
#include "canopen/clock.h"

namespace mqtt {

/// Who is to hear what became of a command.
struct Asker {
  ReplyTo to;
  Duplicates::Ticket ticket = Duplicates::kNone;
};

/// What is under way at one drive.
struct DriveLoad {
  process::Drive* drive = nullptr;  ///< Null: it is gone.
  std::size_t commands = 0;
  std::size_t reads = 0;  ///< Apart, for a command must not fail because of them.
};

/// What the commands under way share with the requests, which they may outlive by the time a drive takes to stop.
struct UnderWay {
  using Publish = std::function<void(Message)>;

  /// Repetitions that wait for what becomes of their first; further ones are answered at once, without it.
  static constexpr std::size_t kMaxWaiting = 1000;

  UnderWay(const boost::asio::any_io_executor& executor, process::Plant& plant, Publish to_publish);

  /// The plant's drives are others.
  void change(process::Plant& plant, const process::PlantChange& change);

  void send(Message message) const {
    if (publish) {
      publish(std::move(message));
    }
  }
  /// Answers a command and the repetitions that wait for this, and remembers it for later ones.
  void settle(const Asker& asker, const process::Outcome& outcome);
  /// Answers a repetition as soon as the outcome of its first is known.
  void repeat(const ReplyTo& to, const Duplicates::Earlier& earlier);
  /// A command or a read begins, or ends; `load` null: a stop of all.
  void begins(DriveLoad* load, bool is_read);
  void ended(DriveLoad* load, bool is_read);

  Publish publish;  ///< Empty after stop().
  bool open = true;
  std::vector<std::shared_ptr<DriveLoad>> loads;  ///< By drive. What is under way holds its own, too.
  std::size_t total = 0;
  std::size_t reads = 0;  ///< Of them.
  Duplicates duplicates;
  std::multimap<Duplicates::Ticket, ReplyTo> waiting;  ///< Repetitions, by their first.
  canopen::Timer idle;                                 ///< Cancelled when the last one ended.
};

/// Carries out one command, waits for its outcome and sends the answer. `load` null: a stop of all. Parameters by
/// value: what a coroutine refers to lives in its frame, or longer than it; a drive that goes answers all that it was
/// asked before.
boost::asio::awaitable<void> carry_out(std::shared_ptr<UnderWay> under_way, process::Plant& plant,
                                       std::shared_ptr<DriveLoad> load, process::Origin origin, Asked asked,
                                       Asker asker);

}  // namespace mqtt
