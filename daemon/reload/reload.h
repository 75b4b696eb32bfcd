#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bridges/disk/worker.h"
#include "canopen/clock.h"
#include "canopen/event.h"
#include "config/load.h"
#include "daemon/reload/effective_model.h"

namespace process {
class Drive;
}

namespace gateway {

class Gateway;

/// Takes another configuration while the gateway runs. It is loaded and checked first, beside the loop; one with
/// errors, or with another [gateway], changes nothing. What was accepted is wanted from then on: what cannot be taken
/// while a motor turns waits, and is taken as soon as it stands still (see effective_model()). A newer one takes its
/// place.
class Reload {
 public:
  struct Handlers {
    std::function<config::Loaded()> load;  ///< Called in a thread of its own.
    std::function<void()> begins{};        ///< On the loop: a configuration is being looked at,
    std::function<void()> ends{};          ///< and all that can be taken was, or nothing.
  };

  /// How often it is looked at whether a drive that is waited for stands still.
  static constexpr canopen::Duration kLook = std::chrono::milliseconds(100);

  /// `gateway` outlives it.
  Reload(const boost::asio::any_io_executor& executor, Gateway& gateway, Handlers handlers);
  Reload(const Reload&) = delete;
  Reload& operator=(const Reload&) = delete;

  /// From now on; the gateway has started.
  void start();
  /// Several before the first is begun are one, and those during one are one more. Harmless before start() and after
  /// stop().
  void request();
  /// Before the gateway stops: what is being stopped is awaited, and nothing more is begun.
  boost::asio::awaitable<void> stop();

  /// Drives that are not yet as they are wanted.
  [[nodiscard]] const std::vector<WaitingDrive>& waiting() const noexcept { return waiting_; }

 private:
  boost::asio::awaitable<void> run();
  boost::asio::awaitable<void> take();
  boost::asio::awaitable<std::shared_ptr<config::Loaded>> load();
  boost::asio::awaitable<void> apply();
  /// Why a drive is not to be replaced now.
  enum class Hold : std::uint8_t { none, turns, unknown, doubled };
  [[nodiscard]] Hold hold_of(const process::Drive& drive) const;
  [[nodiscard]] bool keeps_its_place(const process::Drive& drive) const;
  [[nodiscard]] std::string reason_of(const WaitingDrive& waiting) const;
  void tell_waiting(std::vector<WaitingDrive> waiting);

  boost::asio::any_io_executor executor_;
  Gateway& gateway_;
  Handlers handlers_;
  disk::Worker worker_;
  canopen::Event changed_;
  std::optional<config::Model> wanted_;  ///< Nothing: what is wanted is in use.
  std::vector<WaitingDrive> waiting_;
  std::vector<Hold> seen_;      ///< Of the plant's drives at the last look that changed nothing; else empty.
  std::set<std::string> told_;  ///< Lines of the log about what waits.
  bool requested_ = false;
  bool running_ = false;
  bool stopping_ = false;
};

}  // namespace gateway
