// The alarm `data` of a drive on a bus: what it does not have, and where its emergencies go.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/process/drive_bench.h"

namespace process {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr canopen::ObjectAddress kEmcyId{0x1014, 0};

class DataAlarmTest : public DriveBench {
 protected:
  [[nodiscard]] const alarms::Alarm& data() const { return alarm(alarms::AlarmKind::data); }
  [[nodiscard]] bool all_fresh() const { return drive_->image().all_fresh(canopen::Clock::now()); }
  void set_emcy_id(Raw value) { slave_.set(kEmcyId, canopen::DataType::u32, value); }
};

TEST_F(DataAlarmTest, NamesAnObjectThatTheDriveDoesNotHave) {
  slave_.remove(test::kTemperature);
  bring_online();
  run(500ms);
  EXPECT_TRUE(data().active);
  EXPECT_EQ(data().reason, "absent");
  EXPECT_EQ(data().text, "the drive has no object 0x2021:0D (module_temperature)");
  EXPECT_EQ(data().severity, config::Severity::warning);
  EXPECT_TRUE(all_fresh());
  EXPECT_FALSE(fresh("module_temperature"));
  EXPECT_EQ(data().count, 1U);
}

TEST_F(DataAlarmTest, ObserversAreToldThatNobodyWaitsForIt) {
  slave_.remove(test::kTemperature);
  bring_online();
  run(500ms);
  EXPECT_EQ(
      std::count(observer_.stale.begin(), observer_.stale.end(), std::vector<SignalId>{signal("module_temperature")}),
      1);
}

TEST_F(DataAlarmTest, AChangedDriveIsNoticedAtItsBootUp) {
  slave_.remove(test::kTemperature);
  bring_online();
  run(500ms);
  ASSERT_TRUE(data().active);
  slave_.set(test::kTemperature, canopen::DataType::u16, 315);
  slave_.boot_up();
  run(2s);
  EXPECT_FALSE(data().active);
  EXPECT_TRUE(fresh("module_temperature"));
}

TEST_F(DataAlarmTest, ARebootOfTheSameDriveIsOneActivation) {
  slave_.remove(test::kTemperature);
  bring_online();
  run(500ms);
  const std::string id = data().id;
  slave_.boot_up();
  run(2s);
  EXPECT_TRUE(data().active);
  EXPECT_EQ(data().id, id);
  EXPECT_EQ(data().count, 1U);
}

TEST_F(DataAlarmTest, SeveralProblemsHaveTheReasonOfTheFirst) {
  slave_.remove(test::kTemperature);
  slave_.remove(test::kLimit);
  set_emcy_id(0x80000085);
  bring_online();
  run(2s);
  EXPECT_EQ(data().reason, "absent");
  EXPECT_THAT(data().text, HasSubstr("(module_temperature); the drive has no object"));
  EXPECT_THAT(data().text, HasSubstr("(upper_limit); emergencies are switched off in the drive"));
}

TEST_F(DataAlarmTest, EmergenciesThatAreSwitchedOffOrMoved) {
  set_emcy_id(0x80000085);
  bring_online();
  run(500ms);
  EXPECT_EQ(data().reason, "emcy-off");
  EXPECT_EQ(data().text, "emergencies are switched off in the drive: 0x1014:00 is 0x80000085");
  EXPECT_TRUE(drive_->status().online);
  EXPECT_EQ(drive_->status().boot_result, canopen::BootResult::ok);
  EXPECT_TRUE(all_fresh());
  set_emcy_id(0x90);
  slave_.boot_up();
  run(2s);
  EXPECT_EQ(data().reason, "emcy-moved");
  EXPECT_THAT(data().text, HasSubstr("0x1014:00 is 0x00000090, expected 0x00000085"));
  EXPECT_EQ(data().count, 1U);
  set_emcy_id(0x85);
  slave_.boot_up();
  run(2s);
  EXPECT_FALSE(data().active);
  EXPECT_TRUE(sdo_writes().empty());
}

TEST_F(DataAlarmTest, WhereItMayBeWrittenEmergenciesComeAndNoAlarm) {
  model_.node.emcy.enable = true;
  set_emcy_id(0x80000085);
  bring_online();
  run(500ms);
  EXPECT_FALSE(data().active);
  EXPECT_EQ(data().count, 0U);
  EXPECT_EQ(slave_.value(kEmcyId), 0x85U);
  EXPECT_THAT(observer_.remarks, testing::Contains(HasSubstr("0x1014:00 EMCY was 0x80000085")));
}

TEST_F(DataAlarmTest, OfATpdoHasItsReason) {
  bring_online();
  run(500ms);
  silent_ = true;
  run(2s);
  // Its types could not be verified and its objects can be read: nothing is missing.
  EXPECT_FALSE(data().active) << data().text;
  slave_.remove(test::kStatusWord);
  slave_.remove(test::kOutput);
  slave_.script([](const Bytes& request) -> std::optional<std::vector<Bytes>> {
    if (request[1] != 0x21 && request[1] != 0x30) {
      return std::nullopt;
    }
    return std::vector<Bytes>{{0x80, request[1], request[2], request[3], 0x00, 0x00, 0x00, 0x08}};
  });
  run(3s);
  EXPECT_TRUE(data().active);
  EXPECT_EQ(data().reason, "unreadable");
  EXPECT_THAT(data().text, HasSubstr("TPDO1 is overdue and reading its objects failed"));
}

}  // namespace
}  // namespace process
