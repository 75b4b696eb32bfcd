#include "canopen/node/boot_result.h"

#include <algorithm>
#include <array>

namespace canopen {
namespace {

struct Letter {
  BootResult result;
  HeldBack held_back;
  std::string_view text;
  std::string_view first_steps;
};

constexpr std::array kLetters{
    Letter{BootResult::no_answer, HeldBack::no, "it answers no SDO request",
           "check that it is switched on and wired to this bus, its node id and bit rate, and that SDO is not switched "
           "off in it; where it only answers some seconds after its boot-up, set sdo.patience"},
    Letter{BootResult::other_device_type, HeldBack::no, "another device type than expected",
           "look whether the planned drive has this node id; if it does, correct identity.device_type or the profile, "
           "or, where it cannot be read, leave it out"},
    Letter{BootResult::other_vendor, HeldBack::no, "another vendor than expected",
           "look whether the planned drive has this node id; if it does, correct identity.vendor or the profile, or, "
           "where it cannot be read, leave it out"},
    Letter{BootResult::no_error_control, HeldBack::no, "it runs, and nothing tells that it lives",
           "set its heartbeat time, 0x1017, in the drive, or guarding in its configuration; a toggle bit that stands "
           "still is a fault of the drive"},
    Letter{BootResult::no_guarding, HeldBack::no, "configured, but it does not answer node guarding",
           "check that the drive answers remote frames (RTR), and that the CAN controllers of both sides can; else use "
           "a heartbeat"},
    Letter{BootResult::not_configured, HeldBack::no, "a setting could not be made",
           "look at the object that is named: does the drive have it, may it be written, does the profile fit this "
           "drive and its firmware?"},
    Letter{BootResult::not_configured, HeldBack::start_ignored, "configured, but NMT start has no effect",
           "clear the error that the drive shows, and look whether it waits for a release or a parameter; take its run "
           "command away where it comes from and send a stop, only then NMT start"},
    Letter{
        BootResult::not_configured, HeldBack::left_operational, "it left operational by itself",
        "look at its fault memory, its supply and who else sends NMT commands; take its run command away where it "
        "comes from and send a stop, only then NMT start: with a run command that it still holds it may run at once"},
    Letter{
        BootResult::not_configured, HeldBack::found_stopped, "it was found stopped",
        "find out who stopped it, and why; take its run command away where it comes from; stopped it takes no stop, so "
        "switch it off and on; NMT start only where it surely holds no run command, for with one it may run at once"},
    Letter{BootResult::no_heartbeat, HeldBack::no, "configured, but its heartbeat does not start",
           "compare 0x1017 in the drive: where it keeps a longer time, raise heartbeat_timeout; where it has no "
           "heartbeat, use guarding"},
    Letter{BootResult::left_alone, HeldBack::no, "it runs, or may run, and is not as wanted",
           "take its run command away where it comes from and stop the motor, then NMT pre-operational and start, or, "
           "where that is refused, switch it off and on; or put the object right that is named"},
    Letter{BootResult::other_product, HeldBack::no, "another product than expected",
           "look whether the planned drive has this node id; if it does, correct identity.product or the profile, or, "
           "where it cannot be read, leave it out"},
    Letter{BootResult::other_revision, HeldBack::no, "another revision than expected",
           "if the drive or its firmware was exchanged, check that the profile still fits, then correct "
           "identity.revision, or, where it cannot be read, leave it out"},
    Letter{
        BootResult::other_serial_number, HeldBack::no, "another serial number than expected",
        "if the drive was exchanged, give it the parameters of the old one, then correct identity.serial, or, where it "
        "cannot be read, leave it out"}};

const Letter* letter_of(BootResult result, HeldBack held_back) noexcept {
  const HeldBack as = result == BootResult::not_configured ? held_back : HeldBack::no;
  const auto* const found = std::find_if(kLetters.begin(), kLetters.end(), [&](const Letter& letter) {
    return letter.result == result && letter.held_back == as;
  });
  return found == kLetters.end() ? nullptr : found;
}

}  // namespace

std::string_view text_of(BootResult result, HeldBack held_back) noexcept {
  const Letter* const letter = letter_of(result, held_back);
  return letter == nullptr ? std::string_view() : letter->text;
}

std::string_view first_steps(BootResult result, HeldBack held_back) noexcept {
  const Letter* const letter = letter_of(result, held_back);
  return letter == nullptr ? std::string_view() : letter->first_steps;
}

}  // namespace canopen
