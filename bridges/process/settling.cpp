#include "bridges/process/settling.h"

#include <chrono>

namespace process {
namespace {

// A search ends sooner: it listens for the heartbeat's timeout, asks, and listens again. What restarts all the time may
// never tell.
canopen::Duration patience_of(const config::Drive& drive) {
  return std::chrono::seconds(10) + 3 * drive.node.error_control.heartbeat_timeout;
}

/// What is not received this long after the drive became operational is told as missing, or is nothing to wait for.
constexpr canopen::Duration kSettles = std::chrono::seconds(10);

}  // namespace

Settling::Settling(const boost::asio::any_io_executor& executor, const config::Drive& model, const Image& image,
                   alarms::DriveAlarms& alarms)
    : model_(model),
      image_(image),
      alarms_(alarms),
      patience_(executor, [this] { alarms_.on_patience_over(canopen::wall_now()); }) {}

void Settling::start() {
  patience_.arm(canopen::Clock::now() + patience_of(model_));
}

void Settling::on_status(const canopen::NodeStatus& status) {
  if (!status.online || status.nmt != canopen::NmtState::operational) {
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
