#include "bridges/process/writer.h"

namespace process {

std::string to_string(const Writer& writer) {
  switch (writer.way) {
    case Writer::Way::modbus:
      return writer.address.empty() ? "modbus" : "modbus " + writer.address;
    case Writer::Way::mqtt:
      return "mqtt";
    case Writer::Way::local:
      return writer.user.empty() ? "local" : "local " + writer.user;
    case Writer::Way::gateway:
      break;
  }
  return "gateway";
}

}  // namespace process
