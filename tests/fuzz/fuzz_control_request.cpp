// Lines of the control socket: whatever the bytes, a request or an error, the id is JSON that can be echoed, and what
// has been read of a request fits its drive or is refused.

#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "bridges/mqtt/command.h"
#include "bridges/text/flat_json.h"
#include "daemon/control/order_text.h"
#include "daemon/control/request.h"
#include "tests/unit/mqtt/site.h"

namespace {

using gateway::control::Line;
using gateway::control::Op;
using gateway::control::Request;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

void look_at(const Request& request) {
  static const config::Drive drive = mqtt::test::pump1();
  const bool of_a_drive = request.op != Op::status && request.op != Op::stop;
  require(of_a_drive || (request.drive.empty() && request.values.empty()));
  require((request.op == Op::sdo_write) == request.value.has_value());
  const mqtt::Fields fields = mqtt::fields_of(drive, request.values);
  require(fields.mistake || fields.sound.size() == request.values.size());
}

void read(std::string_view text) {
  const Line line = gateway::control::parse_line(text);
  require(text::parse_flat("{\"id\":" + line.id + "}").has_value());
  if (line.request.has_value()) {
    look_at(line.request.value());
  } else {
    require(!line.request.error().detail.empty());
  }
}

// Whatever is typed becomes JSON, so that a request of the command line is always one.
void typed(std::string_view text) {
  require(text::parse_flat("{\"value\":" + gateway::control::json_of(text) + "}").has_value());
  require(text::parse_flat("{\"value\":" + gateway::control::json_of_raw(text) + "}").has_value());
  const std::string request = R"({"op":"set","drive":"pump1","values":)" +
                              gateway::control::values_of({"a=" + std::string(text)}).value() + "}";
  require(gateway::control::parse_line(request).request.has_value());
  require(request.find('\n') == std::string::npos);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  read(text);
  typed(text);
  return 0;
}
