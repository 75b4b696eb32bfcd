#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridges/process/alarms.h"
#include "bridges/process/commands.h"
#include "bridges/process/drive.h"
#include "bridges/process/image.h"
#include "bridges/process/inputs.h"
#include "bridges/process/observer.h"
#include "bridges/process/reader.h"
#include "canopen/node/node_events.h"
#include "canopen/node/remote_node.h"
#include "canopen/wake_up.h"

namespace process {

/// The inside of a Drive: hands what the remote node tells to inputs, alarms and commands, and what changes to the
/// observers.
class Drive::Body final : private canopen::NodeEvents, private Inputs::Listener {
 public:
  Body(const boost::asio::any_io_executor& executor, const config::Drive& model, std::size_t index, canopen::Bus& bus,
       const std::vector<Observer*>& observers, const Drive& drive);
  virtual ~Body() = default;
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;

  void start();
  void close();
  boost::asio::awaitable<void> stop();

  [[nodiscard]] const config::Drive& model() const noexcept { return model_; }
  [[nodiscard]] std::size_t index() const noexcept { return index_; }
  [[nodiscard]] const Image& image() const noexcept { return image_; }
  [[nodiscard]] const canopen::NodeStatus& status() const noexcept { return node_.status(); }
  [[nodiscard]] Alarms& alarms() noexcept { return alarms_; }
  [[nodiscard]] const Alarms& alarms() const noexcept { return alarms_; }
  [[nodiscard]] Commands& commands() noexcept { return commands_; }

 private:
  // canopen::NodeEvents
  void on_status(const canopen::NodeStatus& status) override;
  void on_boot_up() override;
  void on_arrival(canopen::Arrival arrival) override;
  void on_tpdo(std::uint16_t number, std::span<const canopen::Raw> values, canopen::TimePoint at,
               canopen::WallTime wall) override;
  void on_tpdo_length(std::uint16_t number, std::size_t expected, std::size_t received) override;
  void on_emcy(const canopen::Emcy& emcy, canopen::TimePoint at, canopen::WallTime wall) override;
  void on_frames_lost() override;

  // Inputs::Listener
  void on_values(SourceId source) override;
  void on_stale(SourceId source) override;
  void on_problems() override;
  void on_remark(const std::string& text) override;  ///< Of both.
  void on_read_wanted() override;

  /// A signal that decides on alarms and on what may be sent again.
  struct Indicator {
    SignalId signal;
    SourceId source;
  };
  [[nodiscard]] std::optional<Indicator> indicator(const std::optional<std::size_t>& signal) const;
  [[nodiscard]] bool is_from(const std::optional<Indicator>& indicator, SourceId source) const noexcept {
    return indicator && indicator->source == source;
  }
  void void_commands(SourceId source);
  void on_quick_stop();
  void tell_alarms(SourceId source);
  void tell_bit(const std::optional<Indicator>& indicator, config::Severity severity, SourceId source);
  void watch_bits(canopen::TimePoint now);
  void arm_expiry();
  template <class Tell>
  void tell(Tell tell_one) const;

  const config::Drive& model_;
  std::size_t index_;
  const std::vector<Observer*>& observers_;
  const Drive& drive_;
  Image image_;
  canopen::RemoteNode node_;
  Inputs inputs_;
  Alarms alarms_;
  Commands commands_;
  Reader reader_;
  canopen::WakeUp expiry_;
  canopen::TimePoint expiry_for_ = canopen::kNever;  ///< What it is set for.

  std::optional<Indicator> fault_;
  std::optional<Indicator> warning_;
  std::optional<Indicator> running_;
  std::optional<Indicator> quick_stop_;
  std::optional<Indicator> fault_code_;
  bool was_running_ = false;
  bool had_fault_ = false;
  bool had_quick_stop_ = false;
  bool was_online_ = false;
};

}  // namespace process
