#include "canopen/node/wanted_objects.h"

#include <algorithm>
#include <string>

#include "canopen/communication_objects.h"
#include "canopen/node/error_control_setup.h"
#include "canopen/node/pdo_times.h"

namespace canopen {
namespace {

constexpr std::uint16_t kRpdoCommunication = 0x1400;
constexpr std::uint16_t kTpdoCommunication = 0x1800;
constexpr std::uint16_t kMappingOffset = 0x200;  // 0x1600 and 0x1A00.
constexpr std::uint8_t kCobId = 1;
constexpr std::uint8_t kTransmissionType = 2;

}  // namespace

std::string pdo_name(PdoRole role, const PdoSettings& pdo) {
  return (role == PdoRole::transmit ? "TPDO" : "RPDO") + std::to_string(pdo.number);
}

std::uint16_t pdo_communication(PdoRole role, const PdoSettings& pdo) noexcept {
  return static_cast<std::uint16_t>((role == PdoRole::transmit ? kTpdoCommunication : kRpdoCommunication) + pdo.number -
                                    1);
}

SetupItem wanted_cob_id(PdoRole role, const PdoSettings& pdo, Raw wanted) {
  return {{pdo_communication(role, pdo), kCobId},
          DataType::u32,
          wanted,
          pdo_name(role, pdo) + " COB-ID",
          pdo.communication};
}

std::vector<SetupItem> wanted_parameters(PdoRole role, const PdoSettings& pdo) {
  const std::uint16_t communication = pdo_communication(role, pdo);
  const std::string name = pdo_name(role, pdo);
  std::vector<SetupItem> items;
  if (pdo.communication == SetupPolicy::assume) {
    items.push_back({{communication, kPdoEventTimer},
                     DataType::u16,
                     pdo.event_timer.value_or(0),
                     name + " event timer",
                     SetupPolicy::write});
    return items;
  }
  const auto add = [&](std::uint8_t sub, DataType type, const auto& wanted, const char* what) {
    if (wanted) {
      items.push_back({{communication, sub}, type, *wanted, name + what, pdo.communication});
    }
  };
  add(kTransmissionType, DataType::u8, pdo.transmission_type, " transmission type");
  add(kPdoInhibitTime, DataType::u16, pdo.inhibit_time, " inhibit time");
  add(kPdoEventTimer, DataType::u16, pdo.event_timer, " event timer");
  if (role == PdoRole::transmit && pdo.communication == SetupPolicy::write) {
    std::for_each(items.begin(), items.end(), [&pdo](SetupItem& item) { allow_rounding(item, pdo); });
  }
  return items;
}

std::vector<SetupItem> wanted_mapping(PdoRole role, const PdoSettings& pdo) {
  const auto mapping = static_cast<std::uint16_t>(pdo_communication(role, pdo) + kMappingOffset);
  const std::string name = pdo_name(role, pdo);
  std::vector<SetupItem> items{
      {{mapping, 0}, DataType::u8, pdo.mapping.size(), name + " number of mapped objects", pdo.mapping_policy}};
  for (const MappedObject& mapped : pdo.mapping) {
    const Raw entry = (Raw{mapped.object.index} << 16U) | (Raw{mapped.object.sub} << 8U) | mapped.bits;
    const auto sub = static_cast<std::uint8_t>(items.size());
    items.push_back({{mapping, sub}, DataType::u32, entry, name + " mapping", pdo.mapping_policy});
  }
  return items;
}

bool relies_on_timer(const PdoSettings& pdo) noexcept {
  return pdo.event_timer_required && pdo.event_timer;
}

std::string why_not_without_object(PdoRole role, const PdoSettings& pdo) {
  return relies_on_timer(pdo) ? why_not_without_timer(role, pdo) : why_not_without_mapping(role, pdo);
}

// A layout is to be written where there is none to rely on: a PDO that means something else may fit in length.
std::string why_not_without_mapping(PdoRole role, const PdoSettings& pdo) {
  if (pdo.mapping_policy != SetupPolicy::write) {
    return "";
  }
  return to_string(wanted_mapping(role, pdo).front().object) + " " + pdo_name(role, pdo) +
         " mapping: the drive does not have it, so what this PDO holds is not known; where the manual tells it, "
         "`mapping = \"assume\"`";
}

// It ends what was commanded where commands cease.
std::string why_not_without_timer(PdoRole role, const PdoSettings& pdo) {
  if (!relies_on_timer(pdo)) {
    return "";
  }
  return to_string(ObjectAddress{pdo_communication(role, pdo), kPdoEventTimer}) + " " + pdo_name(role, pdo) +
         " event timer: the drive does not have it, so it would not notice that commands cease";
}

SetupItem wanted_heartbeat(const ErrorControlSettings& control) {
  const ErrorControlKind kind = kind_of(control);
  const Raw wanted = kind == ErrorControlKind::heartbeat ? whole_ms(control.heartbeat) : 0;
  SetupItem item{kProducerHeartbeat, DataType::u16, wanted, "heartbeat time", control.policy};
  item.least = 1;
  if (kind == ErrorControlKind::none) {
    item.most = 0xFFFF;  // One that nobody asked for does no harm.
  } else if (kind == ErrorControlKind::heartbeat || control.supervise_gateway <= Duration::zero()) {
    item.most = whole_ms(control.heartbeat_timeout - std::chrono::nanoseconds(1));
  }  // Without requests of ours nothing would start its life guarding, so there a heartbeat will not do.
  return item;
}

}  // namespace canopen
