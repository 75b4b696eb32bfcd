// Any bytes a client may send, through framing and validation. What both promise is checked, not only that they live.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "bridges/modbus/general_reference.h"
#include "bridges/modbus/identification.h"
#include "bridges/modbus/mbap.h"
#include "bridges/modbus/request.h"

namespace {

using Bytes = std::span<const std::uint8_t>;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

void check_framing(Bytes bytes, const modbus::FoundFrame& found) {
  // The verdict does not hang on how the bytes came in.
  for (std::size_t size = 0; size < bytes.size() && size < modbus::kMaxFrame; ++size) {
    const modbus::FoundFrame earlier = modbus::find_frame(bytes.first(size));
    if (earlier.framing == modbus::Framing::broken) {
      require(found.framing == modbus::Framing::broken);
    }
    if (earlier.framing == modbus::Framing::complete) {
      require(found.framing == modbus::Framing::complete && found.size == earlier.size);
    }
  }
}

// Function 43: whatever it asks for, the answer is a PDU.
void check_encapsulated(const modbus::Request& request, Bytes pdu) {
  require(!request.reads() && !request.writes());
  require(request.encapsulated.data() == pdu.data() && request.encapsulated.size() == pdu.size());
  if (modbus::Encapsulated{pdu[1]} == modbus::Encapsulated::device_identification) {
    using enum modbus::IdentityId;
    const std::vector<modbus::IdentityObject> objects{{vendor_name, "v"},
                                                      {product_code, std::string(120, 'p')},
                                                      {revision, std::string(120, 'r')},
                                                      {name, std::string(300, 'n')},
                                                      {serial_number, modbus::Exception::no_response},
                                                      {software_version, "s"}};
    (void)modbus::asks_for(pdu, serial_number);
    const modbus::EncapsulatedAnswer answer = modbus::identify(pdu, objects);
    const auto* const worded = std::get_if<std::vector<std::uint8_t>>(&answer);
    require(worded == nullptr || (worded->size() >= 7 && worded->size() <= modbus::kMaxPdu));
    return;
  }
  const auto parsed = modbus::parse_reference(pdu);
  if (const auto* const reference = std::get_if<modbus::Reference>(&parsed)) {
    require(reference->write != reference->data.empty());
    static constexpr std::array<std::uint8_t, 300> kObject{};
    const auto read = modbus::bytes_read(pdu, *reference, kObject);
    require(read.size() <= modbus::kMaxPdu && modbus::word_at(read, 10) == read.size() - 12);
    require(modbus::written(pdu).size() == 12);
  }
}

void check_request(Bytes frame) {
  const Bytes pdu = modbus::pdu_of(frame);
  const auto parsed = modbus::parse_request(pdu);
  const auto* const request = std::get_if<modbus::Request>(&parsed);
  if (request == nullptr) {
    return;
  }
  if (request->is_encapsulated()) {
    check_encapsulated(*request, pdu);
    return;
  }
  require(request->reads() || request->writes());
  require(std::size_t{request->read.address} + request->read.quantity <= 0x10000);
  require(std::size_t{request->write.address} + request->write.quantity <= 0x10000);
  require(request->read.quantity <= (request->of_bits() ? modbus::kMaxReadBits : modbus::kMaxReadRegisters));
  if (!request->writes() || request->function == modbus::Function::mask_write_register) {
    require(request->values.empty());
    return;
  }
  const std::size_t needed =
      request->of_bits() ? (request->write.quantity + 7U) / 8U : request->write.quantity * std::size_t{2};
  require(request->values.size() == needed);
  if (request->function != modbus::Function::write_single_coil) {
    require(request->values.data() >= pdu.data());
    require(request->values.data() + request->values.size() == pdu.data() + pdu.size());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  for (;;) {
    const modbus::FoundFrame found = modbus::find_frame(bytes);
    check_framing(bytes, found);
    if (found.framing != modbus::Framing::complete) {
      return 0;
    }
    require(found.size > modbus::kHeaderSize && found.size <= modbus::kMaxFrame && found.size <= bytes.size());
    (void)modbus::unit_of(bytes);
    check_request(bytes.first(found.size));
    bytes = bytes.subspan(found.size);
  }
}
