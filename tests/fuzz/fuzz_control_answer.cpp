// Answers of whoever listens at the control socket: whatever the bytes, a value that its type can hold, or why there is
// none.

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>

#include "daemon/compare/compare.h"
#include "daemon/compare/reading.h"

namespace {

using gateway::compare::Reading;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

void read_as(canopen::DataType type, const std::string& answer) {
  int asked = 0;
  const Reading reading = gateway::compare::read_object(
      [&](const std::string&) {
        ++asked;
        return std::optional(answer);
      },
      "pump1", {0x1017, 0}, type);
  require(asked == 1 || asked == 2);
  require(reading.kind != Reading::Kind::value || canopen::normalise(type, reading.raw) == reading.raw);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string answer(data, data + size);
  for (const canopen::DataType type :
       {canopen::DataType::boolean, canopen::DataType::u16, canopen::DataType::i32, canopen::DataType::u64}) {
    read_as(type, answer);
  }
  if (const auto running = gateway::compare::read_running(answer)) {
    for (const auto& drive : running->drives) {
      require(drive.name.size() <= answer.size() && drive.boot_text.size() <= answer.size());
    }
  }
  return 0;
}
