#include <algorithm>

#include "config/drive/builder.h"

namespace config {
namespace {

/// What one `[[live]]` says; what is wrong with it has its finding.
void take_live_check(DriveDraft& draft, const Said<LiveKeys>& said) {
  const LiveKeys& keys = said.keys;
  if (!keys.object.has_value() || !keys.type.has_value() || keys.check.name.empty()) {
    return;
  }
  const std::string where = "live \"" + keys.check.name + "\": ";
  if (canopen::is_real(*keys.type)) {
    draft.error(place_of(said, "type"), where + "only integers can be compared");
    return;
  }
  if (keys.equals.empty() == keys.check.limits.empty()) {
    draft.error(said.place, where + "give equals, the values that are right, or limits, the signal that it limits");
    return;
  }
  LiveCheck check = keys.check;
  check.object = *keys.object;
  check.type = *keys.type;
  check.mask = keys.mask.has_value() ? static_cast<canopen::Raw>(*keys.mask) : ~canopen::Raw{0};
  for (const std::int64_t value : keys.equals) {
    check.equals.push_back(static_cast<canopen::Raw>(value));
  }
  draft.notes.live.push_back(std::move(check));
}

}  // namespace

void take_notes(DriveDraft& draft) {
  draft.notes.trial = draft.said.trial;
  for (const Said<LiveKeys>& said : draft.said.live) {
    take_live_check(draft, said);
  }
}

}  // namespace config
