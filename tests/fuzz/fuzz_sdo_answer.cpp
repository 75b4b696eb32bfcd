// SDO answers of any length and content, in any order, against uploads and downloads with every quirk on or off.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "canopen/sdo/transfer.h"

namespace {

using canopen::SdoTransfer;

constexpr canopen::ObjectAddress kObject{0x2030, 3};

void require(bool condition) {
  if (!condition) {
    __builtin_trap();
  }
}

/// Byte 0: bit 0 download, 1 short answers, 2 upload-style confirmations, 3 late answers possible, 4..7 length of the
/// object's type or of the data.
SdoTransfer begin(std::uint8_t choice) {
  canopen::SdoSettings settings;
  settings.accept_short_answers = (choice & 0x02U) != 0;
  settings.accept_upload_style_write_answer = (choice & 0x04U) != 0;
  const std::size_t length = choice >> 4U;
  if ((choice & 0x01U) == 0) {
    return SdoTransfer::upload(settings, kObject, length);
  }
  const std::vector<std::uint8_t> data(length + 1, 0xA5);
  return SdoTransfer::download(settings, kObject, data);
}

void check(const SdoTransfer& transfer, SdoTransfer::Step step, bool download) {
  require(transfer.data().size() <= SdoTransfer::kMaxBytes);
  switch (step) {
    case SdoTransfer::Step::ignored:
      break;
    case SdoTransfer::Step::more:
      require(transfer.in_segments());
      require((transfer.request()[0] >> 5U) == (download ? 0 : 3));
      break;
    case SdoTransfer::Step::completed:
      require(transfer.error() == canopen::Error{});
      require(transfer.is_upload() != download);
      break;
    case SdoTransfer::Step::failed:
      require(transfer.error().kind == canopen::ErrorKind::refused ||
              transfer.error().kind == canopen::ErrorKind::protocol);
      require(!transfer.abort() || (*transfer.abort())[0] == 0x80);
      break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const std::uint8_t choice = bytes[0];
  const bool download = (choice & 0x01U) != 0;
  SdoTransfer transfer = begin(choice);
  std::span<const std::uint8_t> rest(bytes + 1, size - 1);
  bool over = false;
  // Each answer: a length, of which the low four bits count, and that many bytes.
  while (!rest.empty()) {
    const std::size_t length = std::min<std::size_t>(rest[0] & 0x0FU, rest.size() - 1);
    const std::span<const std::uint8_t> answer = rest.subspan(1, length);
    rest = rest.subspan(1 + length);
    // An own allocation of exactly that size: the sanitizer sees a byte read beyond it.
    const std::vector<std::uint8_t> copy(answer.begin(), answer.end());
    const SdoTransfer::Step step = transfer.on_answer(copy, (choice & 0x08U) != 0);
    require(!over || step == SdoTransfer::Step::ignored);
    check(transfer, step, download);
    over = over || step == SdoTransfer::Step::completed || step == SdoTransfer::Step::failed;
  }
  return 0;
}
