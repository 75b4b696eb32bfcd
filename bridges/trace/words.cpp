#include "bridges/trace/words.h"

#include <optional>

#include "bridges/alarms/fault_naming.h"
#include "bridges/trace/object_words.h"
#include "canopen/cob_id.h"
#include "canopen/hex.h"
#include "canopen/nmt.h"
#include "canopen/node/error_report.h"

namespace trace {
namespace {

using canopen::Frame;
using canopen::hex;

constexpr std::uint32_t kTimeCobId = 0x100;       // CiA 301 table 74
constexpr std::uint32_t kLssAnswerCobId = 0x7E4;  // CiA 305
constexpr std::uint32_t kLssRequestCobId = 0x7E5;

const config::Drive* drive_of(const config::Model& model, const Entry& entry) {
  return entry.drive ? &model.drives.at(*entry.drive) : nullptr;
}

// CiA 301 §7.2.8.3.1.
std::string nmt_words(const config::Model& model, const Entry& entry) {
  const auto bytes = entry.frame.bytes();
  if (bytes.size() < 2) {
    return "no command: " + bytes_text(bytes);
  }
  const std::string to = bytes[1] == 0 ? "all nodes"
                         : entry.drive ? owner_of(model, entry) + " (node " + std::to_string(bytes[1]) + ")"
                                       : "node " + std::to_string(bytes[1]);
  const auto command = canopen::nmt_command_of(bytes[0]);
  return (command ? std::string(canopen::name_of(*command)) : "unknown command 0x" + hex(bytes[0], 2)) + ": " + to;
}

// CiA 301 §7.2.8.3.2.
std::string error_control_words(const Entry& entry) {
  if (entry.frame.remote) {
    return "asked for its state (guarding)";
  }
  const auto bytes = entry.frame.bytes();
  if (bytes.empty()) {
    return "no data";
  }
  const unsigned toggle = bytes[0] >> 7U;
  const unsigned number = bytes[0] & 0x7FU;
  if (number == 0 && toggle == 0) {
    return "boot-up";
  }
  const auto state = static_cast<canopen::NmtState>(number);
  std::string text(canopen::name_of(state));
  if (number != 0 && number != 4 && number != 5 && number != 127) {
    text = "unknown state " + std::to_string(number);
  }
  return entry.guarded || toggle != 0 ? text + " (answer to guarding, toggle " + std::to_string(toggle) + ")" : text;
}

std::string other_words(const Frame& frame) {
  if (frame.extended) {
    return "29-bit identifier, no CANopen: " + bytes_text(frame.bytes());
  }
  if (frame.remote) {
    return "asked for";
  }
  return bytes_text(frame.bytes());
}

std::string sync_words(const Frame& frame) {
  return frame.size == 0 ? "" : "counter " + std::to_string(frame.data[0]);
}

std::string lost_words(const Entry& entry) {
  // Who lost them is not known here, and a controller that ran over does not say how many it lost.
  return "at least " + std::to_string(entry.lost) + (entry.lost == 1 ? " frame was" : " frames were") +
         " lost here, in the controller or between it and the gateway";
}

}  // namespace

std::string heading_of(const Entry& entry) {
  switch (entry.kind) {
    case Kind::nmt:
      return "NMT";
    case Kind::heartbeat:
      return entry.frame.remote || entry.guarded ? "guarding" : "heartbeat";
    case Kind::sdo:
      return "SDO";
    case Kind::pdo:
      return (entry.way == PdoWay::transmit ? "TPDO" : "RPDO") + std::to_string(entry.pdo);
    case Kind::emcy:
      return "EMCY";
    case Kind::sync:
      return "SYNC";
    case Kind::error:
      return entry.lost > 0 ? "lost" : "error";
    case Kind::other:
      break;
  }
  if (!entry.frame.extended && entry.frame.id == kTimeCobId) {
    return "TIME";
  }
  const bool is_lss = entry.frame.id == kLssAnswerCobId || entry.frame.id == kLssRequestCobId;
  return is_lss && !entry.frame.extended ? "LSS" : "other";
}

std::string owner_of(const config::Model& model, const Entry& entry) {
  if (entry.drive) {
    return model.drives.at(*entry.drive).name;
  }
  if (entry.kind == Kind::nmt) {
    return entry.node == 0 ? "all" : "node " + std::to_string(entry.node);
  }
  if (entry.node == 0) {
    return {};
  }
  const bool is_ours = entry.bus && model.buses.at(*entry.bus).node_id == entry.node;
  return is_ours ? "gateway" : "node " + std::to_string(entry.node);
}

std::string emcy_words(const config::Drive* drive, const Entry& entry) {
  static const config::FaultRules no_rules;
  const canopen::EmcySettings settings = drive != nullptr ? drive->node.emcy : canopen::EmcySettings{};
  const std::optional<canopen::Emcy> emcy = canopen::decode_emcy(settings, entry.frame.bytes());
  if (entry.frame.remote || !emcy) {
    return "no emergency message: " + bytes_text(entry.frame.bytes());
  }
  const std::string rest =
      "; error register 0x" + hex(emcy->error_register, 2) +
      (emcy->error_register == 0 ? " (no error)" : " (" + canopen::error_register_text(emcy->error_register) + ")") +
      ", vendor bytes " + bytes_text(emcy->vendor);
  const std::string code = "0x" + hex(emcy->code, 4);
  if (emcy->reset) {
    return code + ", an error is over" +
           (emcy->remaining > 0 ? ", " + std::to_string(emcy->remaining) + " remain" : std::string()) + rest;
  }
  const config::FaultText named = alarms::name_emcy(drive != nullptr ? drive->faults : no_rules, settings, *emcy);
  return code + (named.severity == config::Severity::fault ? " fault: " : " warning: ") + named.text + rest;
}

std::string words_of(const config::Model& model, const Entry& entry) {
  switch (entry.kind) {
    case Kind::nmt:
      return nmt_words(model, entry);
    case Kind::heartbeat:
      return error_control_words(entry);
    case Kind::sdo:
      return sdo_words(drive_of(model, entry), entry);
    case Kind::pdo:
      return pdo_words(drive_of(model, entry), entry);
    case Kind::emcy:
      return emcy_words(drive_of(model, entry), entry);
    case Kind::sync:
      return sync_words(entry.frame);
    case Kind::error:
      return entry.lost > 0 ? lost_words(entry) : error_words(entry.frame);
    case Kind::other:
      break;
  }
  return other_words(entry.frame);
}

}  // namespace trace
