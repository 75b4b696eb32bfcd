#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bridges/process/answer.h"
#include "bridges/process/command_journal.h"
#include "tests/unit/modbus/site.h"

// What Modbus refuses by itself was asked for all the same: the drive's journal has it.

namespace {

using modbus_test::example_model;
using modbus_test::Site;
using Kind = process::CommandRecord::Kind;

class Lines final : public process::CommandJournal {
 public:
  boost::asio::awaitable<void> begun(const process::CommandRecord&) override { co_return; }
  void done(const process::CommandRecord& record, const process::Outcome& outcome) override {
    kinds.push_back(record.kind);
    told.push_back(record.writer.address + ": " +
                   (outcome.has_value() ? "ok"
                                        : std::string(process::answer_of(outcome.error().kind).mqtt_code) + ", " +
                                              outcome.error().detail));
  }

  std::vector<Kind> kinds;
  std::vector<std::string> told;
};

class RefusedWrites : public testing::Test {
 protected:
  explicit RefusedWrites(config::Model model = example_model()) : site_(std::move(model)) {
    site_.plant().drive(0).set_journal(&lines_);
    site_.bring_up();
  }
  ~RefusedWrites() override { site_.plant().drive(0).set_journal(nullptr); }
  std::string ask(std::string_view pdu) { return site_.ask(pdu); }

  Lines lines_;
  Site site_;
};

TEST_F(RefusedWrites, AnAddressThatTakesNoValueIsNoted) {
  EXPECT_EQ(ask("06 0000 0001"), "86 02");
  EXPECT_EQ(ask("10 03e7 0002 04 00010002"), "90 02");
  EXPECT_EQ(lines_.told,
            (std::vector<std::string>{
                "127.0.0.1: read-only, register 0 is not there, not all of a value, or read only; "
                "asked was register 0: 0x0001",
                "127.0.0.1: read-only, register 999 to 1000 is not there, not all of a value, or read only; "
                "asked was register 999 to 1000: 0x0001 0x0002",
            }));
  EXPECT_EQ(lines_.kinds, (std::vector<Kind>{Kind::write, Kind::write}));
}

TEST_F(RefusedWrites, ANumberThatIsNoNmtCommandIsNoted) {
  EXPECT_EQ(ask("06 03fc 0007"), "86 03");
  EXPECT_EQ(lines_.told, std::vector<std::string>{"127.0.0.1: type, register 1020 takes 1, 2, 128, 129 or 130, not 7"});
  EXPECT_EQ(lines_.kinds, std::vector<Kind>{Kind::nmt});
}

TEST_F(RefusedWrites, AWriteWhoseReadPartFailsIsNoted) {
  EXPECT_EQ(ask("17 2710 0001 012c 0001 02 1388"), "97 02");
  EXPECT_EQ(lines_.told,
            std::vector<std::string>{
                "127.0.0.1: incomplete, what function 23 was to read cannot be read, so nothing was written; "
                "asked was register 300: 0x1388"});
  EXPECT_TRUE(site_.puppet().written.empty());
}

TEST_F(RefusedWrites, AReadIsNoCommand) {
  EXPECT_EQ(ask("03 2710 0001"), "83 02");
  EXPECT_TRUE(lines_.told.empty());
}

class RefusedClients : public RefusedWrites {
 protected:
  static config::Model with_another_client() {
    config::Model model = example_model();
    model.modbus->write_from = {{"192.0.2.7", 32}};
    return model;
  }
  RefusedClients() : RefusedWrites(with_another_client()) {}
};

TEST_F(RefusedClients, AClientThatMayNotWriteIsNoted) {
  EXPECT_EQ(ask("06 012c 1388"), "86 01");
  EXPECT_EQ(lines_.told, std::vector<std::string>{"127.0.0.1: forbidden, [modbus] write_from does not name it; "
                                                  "asked was register 300: 0x1388"});
  EXPECT_TRUE(site_.puppet().written.empty());
}

TEST_F(RefusedClients, AStopForAllOfAClientThatMayNotWriteIsNotedByEachDrive) {
  for (const std::uint8_t unit : {std::uint8_t{0}, std::uint8_t{255}}) {
    lines_.told.clear();
    EXPECT_EQ(site_.ask(site_.client(), unit, "06 0014 0001"), "86 01");
    EXPECT_EQ(lines_.told, std::vector<std::string>{"127.0.0.1: forbidden, [modbus] write_from does not name it"});
    EXPECT_EQ(site_.ask(site_.client(), unit, "06 0014 0000"), "86 01");
    EXPECT_EQ(site_.ask(site_.client(), unit, "06 0015 0001"), "86 01");
    EXPECT_EQ(lines_.told.size(), 1U) << "these would have stopped nothing";
  }
}

class RefusedByAll : public RefusedWrites {
 protected:
  static config::Model without_writers() {
    config::Model model = example_model();
    model.drives[0].commands.writers = {};
    return model;
  }
  RefusedByAll() : RefusedWrites(without_writers()) {}
};

TEST_F(RefusedByAll, AStopForAllThatNoDriveTakesIsNotedByEach) {
  EXPECT_EQ(site_.ask(site_.client(), 0, "06 0014 0001"), "86 01");
  ASSERT_EQ(lines_.told.size(), 1U);
  EXPECT_TRUE(lines_.told[0].starts_with("127.0.0.1: forbidden, ")) << lines_.told[0];
}

}  // namespace
