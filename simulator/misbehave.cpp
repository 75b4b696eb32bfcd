#include "simulator/misbehave.h"

#include <algorithm>
#include <cstddef>
#include <span>

namespace simulator {
namespace {

bool is_initiate_answer(const canopen::Frame& answer) {
  const unsigned specifier = answer.data[0] >> 5U;
  return specifier == 2 || specifier == 3;
}

bool is_segment_answer(const canopen::Frame& answer) {
  return answer.data[0] >> 5U <= 1;
}

std::uint8_t bytes_used(const canopen::Frame& answer) {
  const std::uint8_t command = answer.data[0];
  if (command >> 5U == 3) {
    return 4;  // write done
  }
  if ((command & 0xE3U) == 0x43) {
    return static_cast<std::uint8_t>(8U - ((command >> 2U) & 3U));
  }
  if (command >> 5U == 1) {
    return 1;  // segment written
  }
  if (command >> 5U == 0) {
    return static_cast<std::uint8_t>(8U - ((command >> 1U) & 7U));
  }
  return answer.size;
}

void put_abort(canopen::Frame& answer, const canopen::Frame& request, std::uint32_t code) {
  if (is_segment_answer(answer)) {
    // The object of the transfer is not in the segments; 0 is as good as any for a refused one.
    answer.data = {0x80};
  } else {
    answer.data[0] = 0x80;
    std::copy_n(request.data.begin() + 1, 3, answer.data.begin() + 1);
  }
  answer.size = 8;
  for (unsigned i = 0; i < 4; ++i) {
    answer.data[4 + i] = static_cast<std::uint8_t>(code >> (8 * i));
  }
}

void apply_flaw(canopen::Frame& answer, const canopen::Frame& request, const Misbehaviour& misbehaviour) {
  switch (misbehaviour.sdo_flaw) {
    case SdoFlaw::none:
      break;
    case SdoFlaw::foreign_index:
      ++answer.data[1];
      break;
    case SdoFlaw::foreign_sub_index:
      ++answer.data[3];
      break;
    case SdoFlaw::wrong_toggle:
      answer.data[0] ^= 0x10U;
      break;
    case SdoFlaw::unknown_command:
      answer.data[0] = 0xE0;
      break;
    case SdoFlaw::abort:
      put_abort(answer, request, misbehaviour.abort_code);
      break;
  }
}

bool flaw_fits(SdoFlaw flaw, const canopen::Frame& answer) {
  switch (flaw) {
    case SdoFlaw::none:
      return false;
    case SdoFlaw::foreign_index:
    case SdoFlaw::foreign_sub_index:
      return is_initiate_answer(answer);
    case SdoFlaw::wrong_toggle:
      return is_segment_answer(answer);
    case SdoFlaw::unknown_command:
    case SdoFlaw::abort:
      return true;
  }
  return false;
}

}  // namespace

Abort denial(const Misbehaviour& misbehaviour, Address address) {
  for (const AbsentObject& absent : misbehaviour.absent) {
    if (absent.index == address.index && absent.sub.value_or(address.sub) == address.sub) {
      return absent.sub ? Abort::no_sub_index : Abort::no_object;
    }
  }
  return Abort::none;
}

canopen::Frame with_length(const canopen::Frame& frame, std::optional<std::uint8_t> length) {
  if (!length) {
    return frame;
  }
  return canopen::make_frame(frame.id, std::span(frame.data).first(std::min<std::size_t>(*length, frame.data.size())));
}

canopen::Frame spoil_sdo_answer(const canopen::Frame& request, canopen::Frame answer, Misbehaviour& misbehaviour) {
  const bool exhausted = misbehaviour.flaws_left && *misbehaviour.flaws_left == 0;
  if (!exhausted && flaw_fits(misbehaviour.sdo_flaw, answer)) {
    apply_flaw(answer, request, misbehaviour);
    if (misbehaviour.flaws_left) {
      --*misbehaviour.flaws_left;
    }
  }
  if (misbehaviour.sdo_short) {
    answer.size = std::min(answer.size, bytes_used(answer));
  }
  return with_length(answer, misbehaviour.sdo_length);
}

}  // namespace simulator
