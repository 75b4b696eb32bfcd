#include "bridges/process/writer.h"

namespace process {

std::string to_string(const Writer& writer) {
  switch (writer.way) {
    case Writer::Way::modbus:
      return writer.address.empty() ? "modbus" : "modbus " + writer.address;
    case Writer::Way::mqtt:
      return "mqtt";
    case Writer::Way::local:
      break;
  }
  return "local";
}

}  // namespace process
