#include "daemon/compare/drive_view.h"

namespace gateway::compare {

std::string place_of_drive(const std::string& name) {
  return "drive \"" + name + "\"";
}

Reading DriveView::read(canopen::ObjectAddress object, canopen::DataType type, const std::string& name) {
  if (silent_) {
    return {};
  }
  Reading reading = read_object(ask_, drive_.name, object, type);
  switch (reading.kind) {
    case Reading::Kind::absent:
      ++counts_.absent;
      break;
    case Reading::Kind::unreadable:
      note(config::Finding::Level::warning,
           canopen::to_string(object) + " " + name + " cannot be compared: " + reading.reason);
      break;
    case Reading::Kind::silent:
      silent_ = true;
      note(config::Finding::Level::warning, "does not answer, so the rest of it was not compared: " +
                                                canopen::to_string(object) + " " + name + ": " + reading.reason);
      break;
    case Reading::Kind::value:
      break;
  }
  return reading;
}

Reading::Kind DriveView::compare(const canopen::SetupItem& item, config::Finding::Level level,
                                 const std::string& remedy) {
  const Reading found = read(item.object, item.type, item.name);
  if (found.kind != Reading::Kind::value) {
    return found.kind;
  }
  if (((found.raw ^ item.wanted) & item.mask) == 0) {
    as_it_should();
  } else if (canopen::will_do(item, found.raw)) {
    note(config::Finding::Level::warning, canopen::difference_text(item, found.raw) + ", which will do");
  } else {
    note(level, canopen::difference_text(item, found.raw) + remedy);
  }
  return found.kind;
}

void DriveView::note(config::Finding::Level level, const std::string& text) {
  findings_.push_back({.file = place_of_drive(drive_.name), .level = level, .text = text});
}

}  // namespace gateway::compare
