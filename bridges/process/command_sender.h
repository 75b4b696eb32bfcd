#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>

#include "bridges/process/command.h"
#include "bridges/process/write_plan.h"
#include "canopen/clock.h"
#include "canopen/error.h"
#include "config/model.h"

namespace canopen {
class RemoteNode;
}

namespace process {

/// Sends one step of a command and keeps what may be known afterwards: a value counts as commanded only where it was
/// confirmed, is not momentary, and nothing made earlier commands void since its command arrived.
class CommandSender {
 public:
  /// `model` and `node` outlive it.
  CommandSender(const config::Drive& model, canopen::RemoteNode& node) : model_(model), node_(node) {}

  /// `knowledge` is what knowledge() was when the command arrived.
  boost::asio::awaitable<Outcome> send(WriteStep step, std::uint32_t knowledge, canopen::TimePoint deadline,
                                       StillStands still_stands);

  /// Nothing counts as commanded any more. `keep_repeating`: RPDOs that the drive supervises go on unchanged.
  void make_void(bool keep_repeating);
  /// The node has made void everything by itself (boot-up, loss, leaving operational).
  void on_voided() noexcept { ++knowledge_; }
  /// Grows when earlier commands become void.
  [[nodiscard]] std::uint32_t knowledge() const noexcept { return knowledge_; }

 private:
  boost::asio::awaitable<Outcome> send_rpdo(WriteStep step, std::uint32_t knowledge, canopen::TimePoint deadline);
  boost::asio::awaitable<Outcome> send_sdo(Field field, std::uint32_t knowledge, canopen::TimePoint deadline,
                                           StillStands still_stands);
  /// What made earlier commands void since `knowledge` makes this one, which left after it, void too.
  void make_void_again(std::uint32_t knowledge);
  [[nodiscard]] canopen::Error explain(canopen::Error error, canopen::ObjectAddress object) const;

  const config::Drive& model_;
  canopen::RemoteNode& node_;
  std::uint32_t knowledge_ = 0;
  std::uint32_t silenced_ = 0;  ///< knowledge_ when RPDOs last had to fall silent, too.
};

}  // namespace process
