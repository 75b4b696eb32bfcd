#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "bridges/mqtt/answers.h"
#include "bridges/mqtt/command.h"
#include "bridges/mqtt/message.h"
#include "bridges/process/command.h"
#include "bridges/process/drive.h"
#include "bridges/process/plant.h"
#include "canopen/clock.h"

namespace mqtt {

/// What the commands under way share with the requests, which they may outlive by the time a drive takes to stop.
struct UnderWay {
  using Publish = std::function<void(Message)>;

  UnderWay(const boost::asio::any_io_executor& executor, std::size_t drives, Publish to_publish)
      : publish(std::move(to_publish)), commands(drives), reads(drives), idle(executor) {}

  void send(Message message) const {
    if (publish) {
      publish(std::move(message));
    }
  }
  void ended(std::size_t* among) {
    if (among != nullptr) {
      --*among;
    }
    --total;
    if (total == 0) {
      idle.cancel();
    }
  }

  Publish publish;  ///< Empty after stop().
  bool open = true;
  std::vector<std::size_t> commands;  ///< By drive.
  std::vector<std::size_t> reads;     ///< Likewise; apart, for a command must not fail because of them.
  std::size_t total = 0;
  canopen::Timer idle;  ///< Cancelled when the last one ended.
};

// Each waits for the outcome of one command and sends its answer. Parameters by value: what a coroutine refers to lives
// in its frame, or longer than it.

boost::asio::awaitable<void> write_fields(std::shared_ptr<UnderWay> under_way, process::Drive& drive,
                                          process::Origin origin, std::vector<process::FieldWrite> fields, ReplyTo to);
boost::asio::awaitable<void> stop_every_drive(std::shared_ptr<UnderWay> under_way, process::Plant& plant,
                                              process::Origin origin, ReplyTo to);
boost::asio::awaitable<void> send_nmt(std::shared_ptr<UnderWay> under_way, process::Drive& drive,
                                      process::Origin origin, canopen::NmtCommand nmt, ReplyTo to);
boost::asio::awaitable<void> read_object(std::shared_ptr<UnderWay> under_way, process::Drive& drive, SdoRequest request,
                                         ReplyTo to);
boost::asio::awaitable<void> write_object(std::shared_ptr<UnderWay> under_way, process::Drive& drive,
                                          process::Origin origin, SdoRequest request, ReplyTo to);

}  // namespace mqtt
