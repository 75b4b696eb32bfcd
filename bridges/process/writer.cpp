#include "bridges/process/writer.h"

namespace process {

std::string_view name_of(Writer::Way way) noexcept {
  switch (way) {
    case Writer::Way::modbus:
      return "modbus";
    case Writer::Way::mqtt:
      return "mqtt";
    case Writer::Way::local:
      return "local";
    case Writer::Way::gateway:
      break;
  }
  return "gateway";
}

std::string to_string(const Writer& writer) {
  // Each way has one of them at most.
  const std::string& who = writer.way == Writer::Way::modbus ? writer.address : writer.user;
  std::string text(name_of(writer.way));
  return who.empty() ? text : text.append(" ").append(who);
}

}  // namespace process
