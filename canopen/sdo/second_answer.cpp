#include "canopen/sdo/second_answer.h"

#include <algorithm>

namespace canopen {
namespace {

// Others carry no object, or are part of a longer transfer.
bool names_object(std::uint8_t first_byte) noexcept {
  const SdoAnswer kind = sdo_answer_of(first_byte);
  return kind == SdoAnswer::upload || kind == SdoAnswer::download || kind == SdoAnswer::abort;
}

// CiA 301 §7.5.2.1, §7.5.2.19.
bool never_changes(ObjectAddress object) noexcept {
  constexpr std::uint16_t kType = 0x1000;
  constexpr std::uint16_t kIdentity = 0x1018;
  return object.index == kType || object.index == kIdentity;
}

}  // namespace

void SecondAnswer::on_answered(std::span<const std::uint8_t> answer) noexcept {
  forget();
  const std::optional<ObjectAddress> object = address_of(answer);
  if (!object || !names_object(answer[0])) {
    return;
  }
  First& first = first_.emplace(First{.object = *object, .size = std::min(answer.size(), SdoFrame{}.size())});
  std::copy_n(answer.begin(), first.size, first.answer.begin());
}

void SecondAnswer::on_request(ObjectAddress object) noexcept {
  if (first_ && first_->object == object) {
    forget();
  }
}

SecondAnswer::Verdict SecondAnswer::judge(std::span<const std::uint8_t> answer) const noexcept {
  if (!first_ || answer.empty() || !names_object(answer[0]) || address_of(answer) != first_->object) {
    return Verdict::none;
  }
  const std::span<const std::uint8_t> before = std::span(first_->answer).first(first_->size);
  const bool same = std::equal(before.begin(), before.end(), answer.begin(), answer.end());
  return same || !never_changes(first_->object) ? Verdict::further : Verdict::different;
}

}  // namespace canopen
