#include <fmt/format.h>

#include <optional>
#include <vector>

#include "canopen/communication_objects.h"
#include "canopen/node/consumer_table.h"
#include "canopen/node/error_control_setup.h"
#include "canopen/node/life_guarding.h"
#include "canopen/node/wanted_objects.h"
#include "daemon/compare/remedy.h"
#include "daemon/compare/settings.h"

namespace gateway::compare {
namespace {

using canopen::DataType;
using canopen::ErrorControlSettings;
using canopen::Raw;
using canopen::SetupPolicy;
using Level = config::Finding::Level;

/// The time for which an entry of 0x1016 lets the gateway's heartbeat be missing; nothing: no entry names it, or the
/// drive has no such table.
std::optional<Raw> supervision_found(DriveView& view, std::uint8_t gateway_node) {
  const std::string name = "consumer heartbeat time";
  const Reading count = view.read({canopen::kConsumerHeartbeat.index, 0}, DataType::u8, name);
  for (Raw sub = 1; count.kind == Reading::Kind::value && sub <= count.raw; ++sub) {
    const canopen::ObjectAddress object{canopen::kConsumerHeartbeat.index, static_cast<std::uint8_t>(sub)};
    const Reading entry = view.read(object, DataType::u32, name);
    if (entry.kind == Reading::Kind::value && canopen::consumer_node(entry.raw) == gateway_node &&
        canopen::consumer_time(entry.raw) != 0) {
      return canopen::consumer_time(entry.raw);
    }
  }
  return std::nullopt;
}

void compare_supervision(DriveView& view) {
  const canopen::NodeSettings& node = view.drive().node;
  const ErrorControlSettings& control = node.error_control;
  if (node.gateway_node == 0) {
    return;
  }
  const bool by_heartbeat = control.guarding <= canopen::Duration::zero();
  const Raw wanted = by_heartbeat ? canopen::whole_ms(control.supervise_gateway) : 0;
  const std::optional<Raw> found = supervision_found(view, node.gateway_node);
  if (view.silent()) {
    return;
  }
  const Raw least = wanted - wanted / 4;  // Some keep it in steps of their own; later than wanted is too late.
  if (found ? (*found >= least && *found <= wanted) : wanted == 0) {
    view.as_it_should();
    return;
  }
  const std::string shown = found ? fmt::format("{} ms", *found) : std::string("no entry for it");
  if (wanted == 0) {
    view.note(Level::warning,
              fmt::format("0x1016 supervision of the gateway (node {}): none is configured, found {}: the drive trips "
                          "when our heartbeat is missing that long; set supervise_gateway, or clear it in the drive",
                          node.gateway_node, shown));
    return;
  }
  view.note(Level::error, fmt::format("0x1016 supervision of the gateway (node {}): expected {} ms, found {}{}",
                                      node.gateway_node, wanted, shown, remedy_of(SetupPolicy::write, view.drive())));
}

void compare_guarding(DriveView& view) {
  const ErrorControlSettings& control = view.drive().node.error_control;
  if (control.guarding > canopen::Duration::zero()) {
    const canopen::LifeGuarding wanted = canopen::wanted_life_guarding(control);
    const SetupPolicy policy = wanted.unset() ? SetupPolicy::verify : SetupPolicy::write;
    view.compare({canopen::kGuardTime, DataType::u16, wanted.guard_time, "guard time", policy}, Level::error,
                 remedy_of(policy, view.drive()));
    view.compare({canopen::kLifeTimeFactor, DataType::u8, wanted.factor, "life time factor", policy}, Level::error,
                 remedy_of(policy, view.drive()));
    return;
  }
  const Reading time = view.read(canopen::kGuardTime, DataType::u16, "guard time");
  const Reading factor = view.read(canopen::kLifeTimeFactor, DataType::u8, "life time factor");
  if (time.kind != Reading::Kind::value || factor.kind != Reading::Kind::value) {
    return;
  }
  if (time.raw == 0 || factor.raw == 0) {
    view.as_it_should();
    return;
  }
  view.note(
      Level::warning,
      fmt::format("0x100C guard time {} ms and 0x100D life time factor {}: no guarding is configured, and another "
                  "master has set it; set both to 0 in the drive",
                  time.raw, factor.raw));
}

}  // namespace

void compare_error_control(DriveView& view) {
  const ErrorControlSettings& control = view.drive().node.error_control;
  const bool assumed = control.policy == SetupPolicy::assume;
  view.compare(canopen::wanted_heartbeat(control), assumed ? Level::warning : Level::error,
               remedy_of(control.policy, view.drive()));
  compare_supervision(view);
  compare_guarding(view);
}

}  // namespace gateway::compare
