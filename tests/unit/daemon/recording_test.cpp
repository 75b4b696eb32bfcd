// The gateway, simulated drives that trip, and what is recorded of them.
#include <gmock/gmock.h>

#include <boost/json/parse.hpp>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "daemon/demo_config.h"
#include "daemon/temporary_directory.h"
#include "tests/support/tshark.h"
#include "tests/unit/daemon/demo_model.h"
#include "tests/unit/daemon/demo_plant.h"
#include "tests/unit/daemon/program.h"

namespace gateway {
namespace {

using namespace std::chrono_literals;
using Kind = alarms::AlarmKind;

config::Model recording_model(const TemporaryDirectory& directory) {
  config::Model model = test::demo_model();
  model.modbus.reset();
  model.mqtt.reset();
  model.http.reset();
  model.gateway.control.clear();
  model.gateway.state_dir = (directory.path() / "state").string();
  model.recorder.emplace();
  return model;
}

// Veichi's cards send SDO answers without the bytes that hold nothing, which CiA 301 does not know, nor tshark.
bool is_short_sdo_answer(const std::string& line) {
  const std::size_t data = line.find('#');
  return (line.find(" 583#") != line.npos || line.find(" 585#") != line.npos) && line.size() - data - 1 < 16;
}

struct Directory {
  TemporaryDirectory directory_;
};

class RecordingTest : protected Directory, public test::DemoPlant {
 protected:
  RecordingTest() : DemoPlant(recording_model(directory_)) { begin_plant(); }
  ~RecordingTest() override {
    if (!ended_) {
      end(gateway_);
    }
  }

  [[nodiscard]] std::filesystem::path records() const { return directory_.path() / "state" / "records"; }
  /// The disk's thread has its own time.
  template <class Predicate>
  void await(Predicate done) {
    for (int i = 0; i < 2000 && !done(); ++i) {
      loop_.context().run_one_for(10ms);
    }
    ASSERT_TRUE(done());
  }
  void end(Gateway& gateway) {
    const auto stopped = support::spawn(loop_.executor(), gateway.stop());
    await([&] {
      loop_.advance(1ms);
      return *stopped;
    });
  }
  [[nodiscard]] const alarms::Alarm& alarm(std::size_t drive) {
    return gateway_.plant().drive(drive).alarm(Kind::emcy);
  }
  [[nodiscard]] std::string text_of(const std::string& name) const {
    std::ifstream file(records() / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static double time_of(const std::string& line) { return std::strtod(line.c_str() + 1, nullptr); }

  bool ended_ = false;
};

TEST_F(RecordingTest, OfATrippedDriveHoldsTenSecondsBeforeAndFiveAfterAndOpensInTshark) {
  loop_.advance(15s);
  const double now = std::chrono::duration<double>(canopen::wall_now().time_since_epoch()).count();
  drives_[1]->fault(5);
  loop_.advance(100ms);
  ASSERT_TRUE(alarm(1).active);
  loop_.advance(5s);
  await([&] { return !alarm(1).record.empty(); });
  EXPECT_TRUE(alarm(1).record.ends_with("Z-pump1-emcy.log")) << alarm(1).record;

  std::vector<std::string> lines;
  std::ifstream log(records() / alarm(1).record);
  for (std::string line; std::getline(log, line);) {
    lines.push_back(line);
  }
  ASSERT_GT(lines.size(), 1000U);
  // Four drives send every few milliseconds, so the edges are full.
  EXPECT_NEAR(time_of(lines.front()), now - 10, 0.1);
  EXPECT_NEAR(time_of(lines.back()), now + 5, 0.1);
  EXPECT_TRUE(std::ranges::is_sorted(lines, {}, time_of));
  EXPECT_EQ(std::ranges::count_if(lines, [](const std::string& line) { return line.find(" 085#") != line.npos; }), 1);

  const std::vector<support::Decoded> decoded = support::decode_log_by_tshark(records() / alarm(1).record);
  ASSERT_EQ(decoded.size(), lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(decoded[i].malformed, is_short_sdo_answer(lines[i])) << lines[i] << ": " << decoded[i].info;
  }
}

TEST_F(RecordingTest, OfATrippedDriveIsPutIntoWordsByTrace) {
  loop_.advance(15s);
  drives_[1]->fault(5);
  loop_.advance(6s);
  await([&] { return !alarm(1).record.empty(); });
  const std::string log = (records() / alarm(1).record).string();
  const test::TemporaryFile site(demo_config());
  const auto trace = [&](const std::string& option) {
    test::Program program(
        {"trace", log, "--config", site.path(), "--profile-dir", GATEWAY_SOURCE_DIR "/config/profiles", option});
    EXPECT_EQ(program.exit_code(), 0) << program.output();
    return program.output();
  };
  const std::string words = trace("--kind=emcy");
  EXPECT_THAT(words, testing::HasSubstr(" demo  085 pump1 "));
  EXPECT_THAT(words, testing::HasSubstr(alarm(1).text));
  EXPECT_EQ(std::ranges::count(words, '\n'), 1) << words;
  EXPECT_EQ(trace("--raw"), text_of(alarm(1).record));
}

TEST_F(RecordingTest, NamesTheCommandsOfThatTime) {
  process::Drive& drive = gateway_.plant().drive(1);
  const auto frequency = static_cast<process::SignalId>(drive.model().find("frequency_command").value());
  const auto write = [&](double value) {
    const auto outcome = support::spawn(
        loop_.executor(), drive.write({.writer = {.way = process::Writer::Way::local, .address = {}, .user = "alice"}},
                                      {{frequency, value}}));
    EXPECT_TRUE(loop_.advance_until([&] { return outcome.done(); }, 5s));
  };
  write(10);
  loop_.advance(20s);
  write(20);
  write(99);
  loop_.advance(1s);
  drives_[1]->fault(5);
  loop_.advance(6s);
  await([&] { return !alarm(1).record.empty(); });
  std::string name = alarm(1).record;
  name.replace(name.size() - 3, 3, "json");
  const boost::json::array commands = boost::json::parse(text_of(name)).at("commands").as_array();
  ASSERT_EQ(commands.size(), 2U) << "the first one was too long before";
  EXPECT_EQ(commands[0].at("from").as_string(), "alice");
  EXPECT_EQ(commands[0].at("outcome").as_string(), "ok");
  EXPECT_EQ(commands[0].at("fields").at(0).at("asked").to_number<double>(), 20);
  EXPECT_EQ(commands[1].at("outcome").as_string(), "range");
}

TEST_F(RecordingTest, TheAlarmNamesItAfterARestart) {
  drives_[1]->fault(5);
  loop_.advance(6s);
  await([&] { return !alarm(1).record.empty(); });
  const alarms::Alarm before = alarm(1);
  loop_.advance(11s);
  await([&] {
    std::ifstream file(directory_.path() / "state" / "alarms.json");
    return std::string(std::istreambuf_iterator<char>(file), {}).find(before.record) != std::string::npos;
  });
  end(gateway_);
  ended_ = true;
  // The first one keeps its directory as long as it is there.
  config::Model model = model_;
  model.gateway.state_dir = (directory_.path() / "after").string();
  std::filesystem::copy(directory_.path() / "state", model.gateway.state_dir, std::filesystem::copy_options::recursive);
  Gateway again(loop_.executor(), model, [this](const config::Bus&) { return wire_.connect(); });
  again.start();
  EXPECT_EQ(again.plant().drive(1).alarm(Kind::emcy).record, before.record);
  loop_.advance(10s);
  const alarms::Alarm& after = again.plant().drive(1).alarm(Kind::emcy);
  EXPECT_EQ(after.id, before.id);
  EXPECT_EQ(after.record, before.record) << "and it is not recorded again";
  end(again);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(directory_.path() / "after" / "records")) {
    files += entry.is_regular_file() ? 1U : 0U;
  }
  EXPECT_EQ(files, 2U);
}

}  // namespace
}  // namespace gateway
