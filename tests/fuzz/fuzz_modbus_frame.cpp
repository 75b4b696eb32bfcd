// Any bytes a client may send, through framing and validation. What both promise is checked, not only that they live.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <variant>

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

void check_request(Bytes frame) {
  const Bytes pdu = modbus::pdu_of(frame);
  const auto parsed = modbus::parse_request(pdu);
  const auto* const request = std::get_if<modbus::Request>(&parsed);
  if (request == nullptr) {
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
