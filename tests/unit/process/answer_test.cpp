#include "bridges/process/answer.h"

#include <gtest/gtest.h>

#include <string_view>

#include "bridges/process/writer.h"

namespace process {
namespace {

using canopen::ErrorKind;

TEST(Answer, OfEachKind) {
  struct Row {
    ErrorKind kind;
    std::uint8_t exception;
    std::string_view code;
  };
  for (const Row& row : {Row{ErrorKind::unknown, 0x02, "unknown"}, Row{ErrorKind::read_only, 0x02, "read-only"},
                         Row{ErrorKind::range, 0x03, "range"}, Row{ErrorKind::type, 0x03, "type"},
                         Row{ErrorKind::incomplete, 0x03, "incomplete"}, Row{ErrorKind::refused, 0x04, "refused"},
                         Row{ErrorKind::timeout, 0x0B, "timeout"}, Row{ErrorKind::offline, 0x0B, "offline"},
                         Row{ErrorKind::forbidden, 0x01, "forbidden"}, Row{ErrorKind::lease, 0x01, "lease"},
                         Row{ErrorKind::retained, 0x01, "retained"}, Row{ErrorKind::expired, 0x0B, "expired"},
                         Row{ErrorKind::duplicate, 0x03, "duplicate"}, Row{ErrorKind::protocol, 0x0B, "timeout"}}) {
    EXPECT_EQ(answer_of(row.kind).modbus_exception, row.exception) << row.code;
    EXPECT_EQ(answer_of(row.kind).mqtt_code, row.code);
  }
}

TEST(WriterText, NamesTheWayAndTheAddress) {
  EXPECT_EQ(to_string(Writer{Writer::Way::modbus, "192.0.2.7"}), "modbus 192.0.2.7");
  EXPECT_EQ(to_string(Writer{Writer::Way::mqtt, {}}), "mqtt");
  EXPECT_EQ(to_string(Writer{Writer::Way::local, {}}), "local");
}

}  // namespace
}  // namespace process
