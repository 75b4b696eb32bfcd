// Any emergency frame under any layout: three bytes are an emergency, fewer are none, and the bytes are told as they
// came.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "canopen/node/emcy.h"

namespace {

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 3) {
    return 0;
  }
  const canopen::EmcySettings settings{.layout = static_cast<canopen::EmcyLayout>(data[0] % 3),
                                       .reset_counts_remaining = (data[0] & 0x80) != 0,
                                       .drive_code_under = static_cast<std::uint16_t>(data[1] << 8 | data[2])};
  // On the heap and just large enough, so that a sanitizer sees every step beyond.
  const std::vector<std::uint8_t> bytes(data + 3, data + size);
  const auto emcy = canopen::decode_emcy(settings, bytes);
  require(emcy.has_value() == (bytes.size() >= 3));
  if (!emcy) {
    return 0;
  }
  require(emcy->code == (bytes[0] | bytes[1] << 8) && emcy->error_register == bytes[2]);
  const std::size_t vendor_bytes = std::min<std::size_t>(bytes.size() - 3, 5);
  for (std::size_t i = 0; i < emcy->vendor.size(); ++i) {
    require(emcy->vendor[i] == (i < vendor_bytes ? bytes[3 + i] : 0));
  }
  require(!(emcy->reset && emcy->drive_code));
  require(emcy->remaining == 0 || (emcy->reset && settings.reset_counts_remaining));
  require(emcy->code != 0 || emcy->reset);
  if (settings.layout == canopen::EmcyLayout::drive_code && emcy->code != 0) {
    require(!emcy->reset && emcy->drive_code == emcy->code);
  }
  return 0;
}
