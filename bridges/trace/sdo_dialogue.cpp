#include "bridges/trace/sdo_dialogue.h"

#include <algorithm>

#include "canopen/sdo/frames.h"

namespace trace {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kHead = 4;  // command, index, sub-index

std::uint8_t byte_at(Bytes frame, std::size_t position) noexcept {
  return position < frame.size() ? frame[position] : std::uint8_t{0};
}

std::uint32_t word_at(Bytes frame, std::size_t position) noexcept {
  std::uint32_t word = 0;
  for (std::size_t i = 4; i > 0; --i) {
    word = word << 8U | byte_at(frame, position + i - 1);
  }
  return word;
}

canopen::ObjectAddress address_in(Bytes frame) noexcept {
  return {static_cast<std::uint16_t>(byte_at(frame, 1) | byte_at(frame, 2) << 8U), byte_at(frame, 3)};
}

// The data of an expedited frame (CiA 301 §7.2.4.3.3): bit 0 says whether bits 3..2 tell how many bytes are none.
Bytes expedited_data(Bytes frame) noexcept {
  const unsigned first = frame[0];
  const std::size_t unused = (first & 1U) != 0 ? first >> 2U & 3U : 0;
  const Bytes data = frame.subspan(std::min(kHead, frame.size()));
  return data.first(std::min(data.size(), canopen::kMaxExpeditedBytes - unused));
}

}  // namespace

SdoPart SdoDialogue::part(SdoStep step) const noexcept {
  return {.step = step, .knows_object = mode_ != Mode::none, .object = object_};
}

SdoPart SdoDialogue::begin(Mode mode, SdoStep step, Bytes frame) noexcept {
  *this = {};
  if (frame.size() < kHead) {
    return {};
  }
  mode_ = mode;
  object_ = address_in(frame);
  return part(step);
}

SdoPart SdoDialogue::aborted(Bytes frame) noexcept {
  *this = {};
  if (frame.size() < 2 * kHead) {
    return {};
  }
  return {.step = SdoStep::abort, .knows_object = true, .object = address_in(frame), .abort = word_at(frame, kHead)};
}

SdoPart SdoDialogue::whole(SdoPart part, Bytes data) noexcept {
  part.bytes = static_cast<std::uint32_t>(data.size());
  part.kept = static_cast<std::uint8_t>(std::min(data.size(), part.data.size()));
  std::copy_n(data.begin(), part.kept, part.data.begin());
  return part;
}

void SdoDialogue::keep(std::uint32_t position, Bytes data) noexcept {
  if (position < data_.size()) {
    const std::size_t count = std::min(data.size(), data_.size() - position);
    std::copy_n(data.begin(), count, data_.begin() + position);
  }
}

// CiA 301 §7.2.4.3.4 and §7.2.4.3.7: the toggle bit is 0 in the first segment, and changes with each.
bool SdoDialogue::comes_next(Bytes frame) noexcept {
  const bool toggle = canopen::toggle_of(frame[0]);
  const std::size_t size = std::min(frame.size(), segment_.size());
  if (toggle == toggle_) {
    toggle_ = !toggle;
    std::copy_n(frame.begin(), size, segment_.begin());
    return true;
  }
  if (!std::equal(segment_.begin(), segment_.begin() + static_cast<std::ptrdiff_t>(size), frame.begin())) {
    *this = {};
  }
  return false;
}

// CiA 301 §7.2.4.3.4 and §7.2.4.3.7: both directions have the same form.
SdoPart SdoDialogue::segment(SdoStep step, Bytes frame) noexcept {
  const bool fits = mode_ == (step == SdoStep::write_segment ? Mode::download : Mode::upload);
  if (fits && !comes_next(frame)) {
    return {};
  }
  SdoPart told = part(step);
  told.knows_object = fits;
  const std::size_t unused = frame[0] >> 1U & 7U;
  const Bytes data = frame.subspan(1, std::min(frame.size() - 1, canopen::kSegmentBytes - unused));
  told.last = (frame[0] & 1U) != 0;
  told.bytes = static_cast<std::uint32_t>(data.size());
  if (!fits) {
    return told;
  }
  keep(moved_, data);
  moved_ += told.bytes;
  if (told.last) {
    told.bytes = moved_;
    told.kept = static_cast<std::uint8_t>(std::min<std::size_t>(moved_, data_.size()));
    told.data = data_;
  }
  return told;
}

SdoPart SdoDialogue::block_segment(Bytes frame) noexcept {
  SdoPart told = part(SdoStep::block_segment);
  told.number = frame[0] & 0x7FU;
  told.last = (frame[0] & 0x80U) != 0;
  told.bytes = static_cast<std::uint32_t>(frame.size() - 1);
  const std::uint32_t position = block_at_ + (told.number - 1U) * std::uint32_t{canopen::kSegmentBytes};
  keep(position, frame.subspan(1));
  moved_ = position + told.bytes;
  newest_ = told.number;
  last_ = told.last;
  return told;
}

// What was not taken is sent again.
SdoPart SdoDialogue::block_taken(Bytes frame) noexcept {
  SdoPart told = part(SdoStep::block_taken);
  told.number = byte_at(frame, 1);
  const bool all = told.number >= newest_;
  moved_ = all ? moved_ : block_at_ + told.number * std::uint32_t{canopen::kSegmentBytes};
  block_at_ = moved_;
  segments_ = !(all && last_);
  last_ = last_ && all;
  newest_ = 0;
  return told;
}

SdoPart SdoDialogue::block_end(Bytes frame) noexcept {
  SdoPart told = part(SdoStep::block_end);
  const std::uint32_t unused = frame[0] >> 2U & 7U;
  segments_ = false;
  told.bytes = moved_ - std::min(moved_, unused);
  told.kept = static_cast<std::uint8_t>(std::min<std::size_t>(told.bytes, data_.size()));
  told.data = data_;
  return told;
}

SdoPart SdoDialogue::download_request(Bytes frame) noexcept {
  if ((frame[0] & 2U) != 0) {
    return whole(begin(Mode::download, SdoStep::write, frame), expedited_data(frame));
  }
  SdoPart told = begin(Mode::download, SdoStep::write_begin, frame);
  told.bytes = (frame[0] & 1U) != 0 ? word_at(frame, kHead) : 0;
  return told;
}

SdoPart SdoDialogue::block_upload_request(Bytes frame) noexcept {
  switch (frame[0] & 3U) {
    case 0: {
      SdoPart told = begin(Mode::block_upload, SdoStep::block_read, frame);
      told.number = byte_at(frame, kHead);
      return told;
    }
    case 1:
      return part(SdoStep::block_end_taken);
    case 2:
      return block_taken(frame);
    default:
      segments_ = mode_ == Mode::block_upload;
      return part(SdoStep::block_read_start);
  }
}

SdoPart SdoDialogue::on_request(Bytes frame) noexcept {
  if (frame.empty()) {
    return {};
  }
  if (mode_ == Mode::block_download && segments_ && (frame[0] & 0x7FU) != 0) {
    return block_segment(frame);
  }
  switch (canopen::sdo_request_of(frame[0])) {
    case canopen::SdoRequest::download_segment:
      return segment(SdoStep::write_segment, frame);
    case canopen::SdoRequest::download:
      return download_request(frame);
    case canopen::SdoRequest::upload:
      return begin(Mode::upload, SdoStep::read, frame);
    case canopen::SdoRequest::upload_segment:
      return part(SdoStep::ask_segment);
    case canopen::SdoRequest::abort:
      return aborted(frame);
    case canopen::SdoRequest::block_upload:
      return block_upload_request(frame);
    case canopen::SdoRequest::block_download: {
      if ((frame[0] & 1U) != 0) {
        return block_end(frame);
      }
      SdoPart told = begin(Mode::block_download, SdoStep::block_write, frame);
      told.bytes = (frame[0] & 2U) != 0 ? word_at(frame, kHead) : 0;
      return told;
    }
    case canopen::SdoRequest::reserved:
      break;
  }
  return {};
}

// A server may answer a request for blocks in the usual way. AC300CAN1 answers a write like a read (manual §3.1.4, 3).
SdoPart SdoDialogue::upload_answer(Bytes frame) noexcept {
  const bool expedited = (frame[0] & 2U) != 0;
  if (mode_ == Mode::download && expedited && frame.size() >= kHead && address_in(frame) == object_) {
    return part(SdoStep::written);
  }
  SdoPart told = begin(Mode::upload, expedited ? SdoStep::value : SdoStep::value_begin, frame);
  if (expedited && told.step == SdoStep::value) {
    return whole(told, expedited_data(frame));
  }
  told.bytes = (frame[0] & 1U) != 0 ? word_at(frame, kHead) : 0;
  return told;
}

SdoPart SdoDialogue::block_download_answer(Bytes frame) noexcept {
  switch (frame[0] & 3U) {
    case 0: {
      SdoPart told = part(SdoStep::block_write_ready);
      told.knows_object = frame.size() >= kHead;
      told.object = address_in(frame);
      told.number = byte_at(frame, kHead);
      segments_ = mode_ == Mode::block_download;
      return told;
    }
    case 1:
      return part(SdoStep::block_end_taken);
    case 2:
      return block_taken(frame);
    default:
      return {};
  }
}

SdoPart SdoDialogue::on_answer(Bytes frame) noexcept {
  SdoPart told;
  if (frame.empty()) {
    return told;
  }
  if (mode_ == Mode::block_upload && segments_ && (frame[0] & 0x7FU) != 0) {
    told = block_segment(frame);
    told.by_server = true;
    return told;
  }
  switch (canopen::sdo_answer_of(frame[0])) {
    case canopen::SdoAnswer::upload_segment:
      told = segment(SdoStep::value_segment, frame);
      break;
    case canopen::SdoAnswer::download_segment:
      told = part(SdoStep::segment_taken);
      break;
    case canopen::SdoAnswer::upload:
      told = upload_answer(frame);
      break;
    case canopen::SdoAnswer::download:
      told = {.step = frame.size() < kHead ? SdoStep::unclear : SdoStep::written,
              .knows_object = true,
              .object = address_in(frame)};
      break;
    case canopen::SdoAnswer::abort:
      told = aborted(frame);
      break;
    case canopen::SdoAnswer::block_download:
      told = block_download_answer(frame);
      break;
    case canopen::SdoAnswer::block_upload:
      if ((frame[0] & 1U) != 0) {
        told = block_end(frame);
      } else {
        told = begin(Mode::block_upload, SdoStep::block_read_ready, frame);
        told.bytes = (frame[0] & 2U) != 0 ? word_at(frame, kHead) : 0;
      }
      break;
    case canopen::SdoAnswer::reserved:
      break;
  }
  told.by_server = true;
  return told;
}

}  // namespace trace
