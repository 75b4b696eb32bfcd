#include <linux/can/error.h>

#include <array>
#include <string>
#include <string_view>

#include "bridges/trace/object_words.h"
#include "bridges/trace/words.h"

namespace trace {
namespace {

struct Bit {
  std::uint32_t mask;
  std::string_view text;
};

// Classes that say all by themselves.
constexpr std::array kClasses{Bit{CAN_ERR_TX_TIMEOUT, "a frame did not leave in time"},
                              Bit{CAN_ERR_ACK, "nobody acknowledged a frame of ours"}, Bit{CAN_ERR_BUSOFF, "bus-off"},
                              Bit{CAN_ERR_BUSERROR, "bus error"},
                              Bit{CAN_ERR_RESTARTED, "the controller was restarted"}};
// data[1]
constexpr std::array kController{Bit{CAN_ERR_CRTL_RX_OVERFLOW, "receive buffer of the controller ran over"},
                                 Bit{CAN_ERR_CRTL_TX_OVERFLOW, "transmit buffer of the controller ran over"},
                                 Bit{CAN_ERR_CRTL_RX_WARNING, "warning level of receive errors reached"},
                                 Bit{CAN_ERR_CRTL_TX_WARNING, "warning level of transmit errors reached"},
                                 Bit{CAN_ERR_CRTL_RX_PASSIVE, "error-passive by receive errors"},
                                 Bit{CAN_ERR_CRTL_TX_PASSIVE, "error-passive by transmit errors"},
                                 Bit{CAN_ERR_CRTL_ACTIVE, "error-active again"}};
// data[2]
constexpr std::array kProtocol{Bit{CAN_ERR_PROT_BIT, "single bit error"},
                               Bit{CAN_ERR_PROT_FORM, "frame format error"},
                               Bit{CAN_ERR_PROT_STUFF, "bit stuffing error"},
                               Bit{CAN_ERR_PROT_BIT0, "a dominant bit could not be sent"},
                               Bit{CAN_ERR_PROT_BIT1, "a recessive bit could not be sent"},
                               Bit{CAN_ERR_PROT_OVERLOAD, "bus overload"},
                               Bit{CAN_ERR_PROT_ACTIVE, "active error announcement"},
                               Bit{CAN_ERR_PROT_TX, "while sending"}};

class List {
 public:
  void add(std::string_view text) { text_.append(text_.empty() ? "" : ", ").append(text); }
  template <class Bits>
  void add_bits(const Bits& bits, std::uint32_t value, std::string_view otherwise) {
    bool any = false;
    for (const Bit& bit : bits) {
      if ((value & bit.mask) != 0) {
        add(bit.text);
        any = true;
      }
    }
    if (!any && !otherwise.empty()) {
      add(otherwise);
    }
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace

std::string error_words(const canopen::Frame& frame) {
  List list;
  list.add_bits(kClasses, frame.id, "");
  if ((frame.id & CAN_ERR_LOSTARB) != 0) {
    list.add("arbitration lost" + (frame.data[0] == 0 ? "" : " at bit " + std::to_string(frame.data[0])));
  }
  if ((frame.id & CAN_ERR_CRTL) != 0) {
    list.add_bits(kController, frame.data[1], "trouble of the controller");
  }
  if ((frame.id & CAN_ERR_PROT) != 0) {
    list.add_bits(kProtocol, frame.data[2], "protocol violation");
  }
  if ((frame.id & CAN_ERR_TRX) != 0) {
    list.add("trouble of the transceiver or the wiring");
  }
  // CAN_ERR_CNT of newer kernels; older drivers fill the counters in with a change of the state.
  constexpr std::uint32_t kHasCounters = 0x200;
  if ((frame.id & kHasCounters) != 0 || frame.data[6] != 0 || frame.data[7] != 0) {
    list.add("errors counted: " + std::to_string(frame.data[6]) + " sending, " + std::to_string(frame.data[7]) +
             " receiving");
  }
  return list.text().empty() ? "error frame: " + bytes_text(frame.bytes()) : list.text();
}

}  // namespace trace
