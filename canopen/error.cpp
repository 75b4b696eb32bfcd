#include "canopen/error.h"

#include <array>
#include <boost/throw_exception.hpp>
#include <stdexcept>

#include "canopen/hex.h"

namespace canopen {
namespace {

struct AbortText {
  std::uint32_t code;
  std::string_view text;
};

// CiA 301 §7.2.4.3.17, table 22.
constexpr std::array kAbortTexts{
    AbortText{0x05030000, "Toggle bit not alternated"}, AbortText{0x05040000, "SDO protocol timed out"},
    AbortText{0x05040001, "Client/server command specifier not valid or unknown"},
    AbortText{0x05040002, "Invalid block size (block mode)"},
    AbortText{0x05040003, "Invalid sequence number (block mode)"}, AbortText{0x05040004, "CRC error (block mode)"},
    AbortText{0x05040005, "Out of memory"}, AbortText{0x06010000, "Unsupported access to an object"},
    AbortText{0x06010001, "Attempt to read a write-only object"},
    AbortText{0x06010002, "Attempt to write a read-only object"},
    AbortText{0x06020000, "Object does not exist in the object dictionary"},
    AbortText{0x06040041, "Object cannot be mapped to the PDO"},
    AbortText{0x06040042, "Number and length of mapped objects exceed the PDO length"},
    AbortText{0x06040043, "General parameter incompatibility"},
    AbortText{0x06040047, "General internal incompatibility in the device"},
    AbortText{0x06060000, "Access failed due to a hardware error"},
    AbortText{0x06070010, "Data type or length of service parameter does not match"},
    AbortText{0x06070012, "Length of service parameter too high"},
    AbortText{0x06070013, "Length of service parameter too low"}, AbortText{0x06090011, "Sub-index does not exist"},
    AbortText{0x06090030, "Invalid value for parameter (download)"},
    AbortText{0x06090031, "Value of parameter written too high"},
    AbortText{0x06090032, "Value of parameter written too low"},
    AbortText{0x06090036, "Maximum value is less than minimum value"},
    AbortText{0x060A0023, "Resource not available: SDO connection"}, AbortText{0x08000000, "General error"},
    // In these three states drives refuse SDO writes of what they take only by PDO, too. The AC300CAN1 manual prints
    // the text of 0x08000022 beside 0x08000020.
    AbortText{0x08000020,
              "Data cannot be transferred or stored to the application: local control or the state of the drive "
              "(AC300CAN1: cannot be changed in the current device state), or the object is taken only by PDO: write "
              "the fields together"},
    AbortText{
        0x08000021,
        "Data cannot be transferred or stored because of local control, or the object is taken only by PDO: write "
        "the fields together"},
    AbortText{
        0x08000022,
        "Data cannot be transferred or stored because of the present device state, or the object is taken only by "
        "PDO: write the fields together"},
    AbortText{0x08000023, "Object dictionary dynamic generation failed or no dictionary present"},
    AbortText{0x08000024, "No data available"}};

// Appends `part` behind `separator`, the first one behind ": ".
void append(std::string& text, bool& first, std::string_view part) {
  text += first ? ": " : ", ";
  text += part;
  first = false;
}

}  // namespace

std::string to_string(const Error& error) {
  std::string text(name_of(error.kind));
  if (error.outcome_unknown) {
    text += ", outcome unknown";
  }
  bool first = true;
  if (error.node != 0) {
    append(text, first, "node " + std::to_string(error.node));
  }
  if (error.object != ObjectAddress{}) {
    append(text, first, "object " + to_string(error.object));
  }
  if (error.abort != 0) {
    append(text, first, "SDO abort 0x" + hex(error.abort, 8) + " (" + std::string(abort_text(error.abort)) + ")");
  }
  if (!error.detail.empty()) {
    append(text, first, error.detail);
  }
  return text;
}

std::string_view name_of(ErrorKind kind) noexcept {
  switch (kind) {
    case ErrorKind::unknown:
      return "unknown";
    case ErrorKind::read_only:
      return "read-only";
    case ErrorKind::range:
      return "range";
    case ErrorKind::type:
      return "type";
    case ErrorKind::incomplete:
      return "incomplete";
    case ErrorKind::refused:
      return "refused";
    case ErrorKind::timeout:
      return "timeout";
    case ErrorKind::offline:
      return "offline";
    case ErrorKind::forbidden:
      return "forbidden";
    case ErrorKind::lease:
      return "lease";
    case ErrorKind::retained:
      return "retained";
    case ErrorKind::expired:
      return "expired";
    case ErrorKind::duplicate:
      return "duplicate";
    case ErrorKind::superseded:
      return "superseded";
    case ErrorKind::voided:
      return "void";
    case ErrorKind::protocol:
      return "protocol";
  }
  return "unknown";
}

std::string_view abort_text(std::uint32_t code) noexcept {
  for (const AbortText& known : kAbortTexts) {
    if (known.code == code) {
      return known.text;
    }
  }
  return "unknown abort code";
}

bool is_absent(const Error& error) noexcept {
  constexpr std::uint32_t kNoObject = 0x06020000;
  constexpr std::uint32_t kNoSubIndex = 0x06090011;
  return error.kind == ErrorKind::refused && (error.abort == kNoObject || error.abort == kNoSubIndex);
}

void throw_exception_from_error(const Error& error, const boost::source_location& where) {
  boost::throw_exception(std::runtime_error(to_string(error)), where);
}

}  // namespace canopen
