#include "bridges/process/answer.h"

namespace process {
namespace {

// Modbus Application Protocol V1.1b3 §7.
constexpr std::uint8_t kIllegalFunction = 0x01;
constexpr std::uint8_t kIllegalAddress = 0x02;
constexpr std::uint8_t kIllegalValue = 0x03;
constexpr std::uint8_t kDeviceFailure = 0x04;
constexpr std::uint8_t kTargetDoesNotRespond = 0x0B;

}  // namespace

Answer answer_of(canopen::ErrorKind kind) noexcept {
  using canopen::ErrorKind;
  switch (kind) {
    case ErrorKind::unknown:
      return {kIllegalAddress, "unknown"};
    case ErrorKind::read_only:
      return {kIllegalAddress, "read-only"};
    case ErrorKind::range:
      return {kIllegalValue, "range"};
    case ErrorKind::type:
      return {kIllegalValue, "type"};
    case ErrorKind::incomplete:
      return {kIllegalValue, "incomplete"};
    case ErrorKind::refused:
      return {kDeviceFailure, "refused"};
    case ErrorKind::timeout:
      return {kTargetDoesNotRespond, "timeout"};
    case ErrorKind::offline:
      return {kTargetDoesNotRespond, "offline"};
    case ErrorKind::forbidden:
      return {kIllegalFunction, "forbidden"};
    case ErrorKind::lease:
      return {kIllegalFunction, "lease"};
    case ErrorKind::retained:
      return {kIllegalFunction, "retained"};
    case ErrorKind::expired:
      return {kTargetDoesNotRespond, "expired"};
    case ErrorKind::duplicate:
      return {kIllegalValue, "duplicate"};
    case ErrorKind::superseded:
      return {kDeviceFailure, "superseded"};
    case ErrorKind::voided:
      return {kDeviceFailure, "void"};
    case ErrorKind::protocol:
      // An answer that makes no sense confirms nothing, as if none had come.
      return {kTargetDoesNotRespond, "timeout"};
  }
  return {kDeviceFailure, "unknown"};
}

}  // namespace process
