#include "bridges/process/settling.h"

#include <chrono>

#include "canopen/node/remote_node.h"

namespace process {
namespace {

// A search ends sooner: it listens for the heartbeat's timeout, asks, and listens again. What restarts all the time may
// never tell.
canopen::Duration patience_of(const config::Drive& drive) {
  return std::chrono::seconds(10) + 3 * drive.node.error_control.heartbeat_timeout;
}

/// How often it is looked whether a boot goes on that the patience waits for.
constexpr canopen::Duration kLook = std::chrono::seconds(1);

/// What is not received this long after the drive became operational is told as missing, or is nothing to wait for.
constexpr canopen::Duration kSettles = std::chrono::seconds(10);

}  // namespace

Settling::Settling(const boost::asio::any_io_executor& executor, const config::Drive& model,
                   const canopen::RemoteNode& node, const Image& image, alarms::DriveAlarms& alarms)
    : model_(model), node_(node), image_(image), alarms_(alarms), patience_(executor, [this] { on_patience_over(); }) {}

void Settling::start() {
  patience_.arm(canopen::Clock::now() + patience_of(model_));
}

// A long boot is no silence: it ends, and tells then. One that a boot-up broke off does not.
void Settling::on_patience_over() {
  const std::uint32_t boot_ups = node_.status().boot_ups;
  if (node_.arriving() && boot_ups_.value_or(boot_ups) == boot_ups) {
    boot_ups_ = boot_ups;
    patience_.arm(canopen::Clock::now() + kLook);
  } else {
    alarms_.on_patience_over(canopen::wall_now());
  }
}

void Settling::on_status(const canopen::NodeStatus& status) {
  if (!status.online || status.nmt_now() != canopen::NmtState::operational) {
    operational_since_.reset();
  } else if (!operational_since_) {
    operational_since_ = canopen::Clock::now();
    if (image_.sources().empty()) {  // Nothing will come.
      alarms_.on_settled(canopen::wall_now());
    }
  }
}

void Settling::on_values(SourceId source) {
  if (settled_ || !operational_since_) {
    return;
  }
  const canopen::TimePoint at = image_.sources()[source].at;
  if (image_.all_fresh(at) || at - *operational_since_ >= kSettles) {
    settled_ = true;  // After that each problem is told as it comes.
    alarms_.on_settled(canopen::wall_now());
  }
}

}  // namespace process
