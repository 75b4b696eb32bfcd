// SDO answers of any length and content, in any order, against uploads and downloads, expedited, in segments and by
// block transfer, with every quirk on or off. Of block transfer a small model knows which data may leave and which
// came.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
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

constexpr std::size_t kSegment = 7;
constexpr std::size_t kWhole = 200;

std::uint8_t byte_at(std::size_t position) {
  return static_cast<std::uint8_t>(position * 37 + 1);
}

/// Byte 0: bit 0 download, 1 short answers, 2 upload-style confirmations, 3 late answers possible, 4..7 length of the
/// object's type or of the data; 15: block transfer.
bool is_block(std::uint8_t choice) {
  return choice >> 4U == 15;
}

SdoTransfer begin(std::uint8_t choice) {
  canopen::SdoSettings settings;
  settings.accept_short_answers = (choice & 0x02U) != 0;
  settings.accept_upload_style_write_answer = (choice & 0x04U) != 0;
  settings.block = is_block(choice);
  const std::size_t length = choice >> 4U;
  if ((choice & 0x01U) == 0) {
    return SdoTransfer::upload(settings, kObject, is_block(choice) ? 0 : length);
  }
  std::vector<std::uint8_t> data(is_block(choice) ? kWhole : length + 1);
  for (std::size_t i = 0; i < data.size(); ++i) {
    data[i] = byte_at(i);
  }
  return SdoTransfer::download(settings, kObject, data);
}

/// What is told of a block download: each segment carries what follows the bytes that the server acknowledged.
class DownloadModel {
 public:
  void on_answer(const SdoTransfer& transfer, std::span<const std::uint8_t> answer, SdoTransfer::Step step) {
    if (step != SdoTransfer::Step::more || !transfer.in_block()) {
      return;
    }
    if (answer[0] >> 5U == 5 && (answer[0] & 3U) == 2) {
      acknowledged_ = std::min(acknowledged_ + answer[1] * kSegment, kWhole);
    }
    given_ = 0;
    check(transfer);
  }
  void on_departure(const SdoTransfer& transfer, SdoTransfer::Step step) {
    if (step == SdoTransfer::Step::more) {
      check(transfer);
    }
  }

 private:
  void check(const SdoTransfer& transfer) {
    const canopen::SdoFrame& request = transfer.request();
    if (acknowledged_ == kWhole) {
      require((request[0] & 0xE3U) == 0xC1 && ((request[0] >> 2U) & 7U) == (kSegment - kWhole % kSegment) % kSegment);
      return;
    }
    ++given_;
    require((request[0] & 0x7FU) == given_ && given_ <= 127);
    const std::size_t begin = acknowledged_ + (given_ - 1) * kSegment;
    require(((request[0] & 0x80U) != 0) == (begin + kSegment >= kWhole));
    for (std::size_t i = 0; i < kSegment; ++i) {
      require(request[1 + i] == (begin + i < kWhole ? byte_at(begin + i) : 0));
    }
  }

  std::size_t acknowledged_ = 0;
  std::size_t given_ = 0;
};

/// What came by a block upload, in order.
class UploadModel {
 public:
  void on_answer(const SdoTransfer& transfer, std::span<const std::uint8_t> answer, SdoTransfer::Step step,
                 bool was_in_block) {
    const bool accepted = step == SdoTransfer::Step::taken || step == SdoTransfer::Step::more;
    if (!accepted || !was_in_block) {
      return;
    }
    if (transfer.only_to_confirm()) {
      require(transfer.request()[0] == 0xA1);
      unused_ = (answer[0] >> 2U) & 7U;
      return;
    }
    if ((answer[0] & 0x7FU) == in_order_ + 1U) {
      ++in_order_;
      data_.insert(data_.end(), answer.begin() + 1, answer.begin() + 8);
    }
    if (step == SdoTransfer::Step::more) {
      require(transfer.request()[0] == 0xA2 && transfer.request()[1] == in_order_ && transfer.request()[2] == 31);
      in_order_ = 0;
    }
  }
  void on_completed(const SdoTransfer& transfer) {
    data_.resize(data_.size() - std::min<std::size_t>(unused_, data_.size()));
    require(transfer.data() == data_);
  }

 private:
  std::vector<std::uint8_t> data_;
  unsigned in_order_ = 0;
  unsigned unused_ = 0;
};

/// How often a transfer was completed in each mode. A run of many inputs that never got through one is a failure: then
/// the seeds do not fit the target any more.
class Modes {
 public:
  Modes() = default;
  ~Modes() {
    constexpr std::size_t kMany = 1000;  // One that broke the target is looked at alone.
    if (inputs_ > kMany) {
      for (std::size_t mode = 0; mode < completed_.size(); ++mode) {
        std::fprintf(stderr, "completed: %s %zu\n", kNames[mode], completed_[mode]);
        require(completed_[mode] > 0);
      }
    }
  }
  Modes(const Modes&) = delete;
  Modes& operator=(const Modes&) = delete;

  void begin() {
    ++inputs_;
    block_ = false;
    segments_ = false;
  }
  void look(const SdoTransfer& transfer) {
    block_ = block_ || transfer.in_block();
    segments_ = segments_ || (transfer.in_segments() && !transfer.in_block());
  }
  void completed(bool download) { ++completed_[(block_ ? 4U : segments_ ? 2U : 0U) + (download ? 1U : 0U)]; }

 private:
  static constexpr std::array kNames{"expedited upload",   "expedited download", "segmented upload",
                                     "segmented download", "block upload",       "block download"};
  std::array<std::size_t, kNames.size()> completed_{};
  std::size_t inputs_ = 0;
  bool block_ = false;
  bool segments_ = false;
};

void check(const SdoTransfer& transfer, SdoTransfer::Step step, bool download) {
  require(transfer.data().size() <= SdoTransfer::kMaxBytes);
  switch (step) {
    case SdoTransfer::Step::ignored:
      break;
    case SdoTransfer::Step::taken:
      require(transfer.in_block() && !download);
      break;
    case SdoTransfer::Step::more:
      require(transfer.in_segments() || transfer.block_refused());
      require(transfer.in_block() || transfer.block_refused() || (transfer.request()[0] >> 5U) == (download ? 0 : 3));
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
  static Modes modes;
  modes.begin();
  SdoTransfer transfer = begin(choice);
  DownloadModel downloaded;
  UploadModel uploaded;
  std::span<const std::uint8_t> rest(bytes + 1, size - 1);
  bool over = false;
  // Each answer: a length, of which the low four bits count, and that many bytes. Bit 4: the request leaves before it;
  // bit 5: and all that follow it.
  while (!rest.empty()) {
    const std::uint8_t how = rest[0];
    const std::size_t length = std::min<std::size_t>(how & 0x0FU, rest.size() - 1);
    const std::span<const std::uint8_t> answer = rest.subspan(1, length);
    rest = rest.subspan(1 + length);
    SdoTransfer::Step left = (how & 0x30U) != 0 ? SdoTransfer::Step::more : SdoTransfer::Step::ignored;
    for (unsigned departures = 0; left == SdoTransfer::Step::more && departures <= ((how & 0x20U) != 0 ? 127U : 0U);
         ++departures) {
      left = transfer.on_departure();
      require(!over || left == SdoTransfer::Step::ignored);
      downloaded.on_departure(transfer, left);
    }
    if (left == SdoTransfer::Step::completed) {
      check(transfer, left, download);
      uploaded.on_completed(transfer);
      modes.completed(download);
      over = true;
    }
    // An own allocation of exactly that size: the sanitizer sees a byte read beyond it.
    const std::vector<std::uint8_t> copy(answer.begin(), answer.end());
    const bool was_in_block = transfer.in_block();
    modes.look(transfer);
    const SdoTransfer::Step step = transfer.on_answer(copy, (choice & 0x08U) != 0);
    require(!over || step == SdoTransfer::Step::ignored);
    check(transfer, step, download);
    if (download) {
      downloaded.on_answer(transfer, copy, step);
    } else {
      uploaded.on_answer(transfer, copy, step, was_in_block);
    }
    if (step == SdoTransfer::Step::completed) {
      modes.completed(download);
    }
    over = over || step == SdoTransfer::Step::completed || step == SdoTransfer::Step::failed;
  }
  return 0;
}
