#include "canopen/node/boot_result.h"

namespace canopen {

std::string_view text_of(BootResult result) noexcept {
  switch (result) {
    case BootResult::no_answer:
      return "it answers no SDO request";
    case BootResult::other_device_type:
      return "another device type than expected";
    case BootResult::other_vendor:
      return "another vendor than expected";
    case BootResult::no_error_control:
      return "neither heartbeat nor guarding answers";
    case BootResult::no_guarding:
      return "it does not answer node guarding";
    case BootResult::not_configured:
      return "configuration failed";
    case BootResult::no_heartbeat:
      return "its heartbeat does not start";
    case BootResult::left_alone:
      return "it runs and is not as wanted";
    case BootResult::other_product:
      return "another product than expected";
    case BootResult::other_revision:
      return "another revision than expected";
    case BootResult::other_serial_number:
      return "another serial number than expected";
    case BootResult::ok:
    case BootResult::not_booted:
      break;
  }
  return {};
}

}  // namespace canopen
