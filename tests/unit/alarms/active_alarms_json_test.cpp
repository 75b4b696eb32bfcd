#include "bridges/alarms/active_alarms_json.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>

namespace alarms {
namespace {

TEST(ActiveAlarmsJson, WithoutAnyItIsAnEmptyList) {
  EXPECT_EQ(active_alarms_json({}), "[]");
}

TEST(ActiveAlarmsJson, NamesDrivesAndBusesInTheOrderGiven) {
  Alarm emcy;
  emcy.active = true;
  emcy.code = 0x0005;
  emcy.text = "Overcurrent \"U\"";
  emcy.since = canopen::WallTime(std::chrono::milliseconds(1767323045678));
  emcy.first = true;
  emcy.record = "x.log";
  Alarm bus;
  bus.active = true;
  bus.reason = "bus-off";
  bus.severity = config::Severity::warning;
  bus.since = emcy.since + std::chrono::seconds(1);
  const std::array<ListedAlarm, 2> active{ListedAlarm{.drive = "pump1", .kind = AlarmKind::emcy, .alarm = &emcy},
                                          ListedAlarm{.bus = "can0", .alarm = &bus}};
  EXPECT_EQ(active_alarms_json(active),
            R"([{"drive":"pump1","kind":"emcy","code":"0x0005","reason":"","text":"Overcurrent \"U\"",)"
            R"("severity":"fault","since":"2026-01-02T03:04:05.678Z","first":true,"record":"x.log"},)"
            R"({"bus":"can0","kind":"bus","code":"0x0000","reason":"bus-off","text":"",)"
            R"("severity":"warning","since":"2026-01-02T03:04:06.678Z","first":false}])");
}

}  // namespace
}  // namespace alarms
