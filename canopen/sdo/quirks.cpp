#include "canopen/sdo/quirks.h"

namespace canopen {

bool long_enough(const SdoSettings& settings, std::span<const std::uint8_t> answer, std::size_t needed) noexcept {
  return answer.size() >= 8 || (settings.accept_short_answers && answer.size() >= needed);
}

std::size_t expedited_length(const UploadAnswer& answer, std::size_t expected) noexcept {
  if (answer.size) {
    return *answer.size;
  }
  return expected == 0 || expected > kMaxExpeditedBytes ? kMaxExpeditedBytes : expected;
}

bool confirms_write(const SdoSettings& settings, std::span<const std::uint8_t> answer) noexcept {
  const SdoAnswer kind = sdo_answer_of(answer[0]);
  if (kind == SdoAnswer::download) {
    return true;
  }
  return kind == SdoAnswer::upload && settings.accept_upload_style_write_answer &&
         decode_upload_answer(answer).expedited;
}

}  // namespace canopen
