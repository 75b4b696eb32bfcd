// What happens while another configuration is being taken.

#include <gtest/gtest.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <functional>
#include <optional>
#include <utility>

#include "tests/unit/daemon/reload/reload_bench.h"

namespace gateway {
namespace {

/// Does something as soon as the plant has another configuration.
class AtChange final : public process::Observer {
 public:
  AtChange(process::Plant& plant, std::function<void()> act) : plant_(plant), act_(std::move(act)) { plant.add(*this); }
  ~AtChange() { plant_.remove(*this); }
  AtChange(const AtChange&) = delete;
  AtChange& operator=(const AtChange&) = delete;
  void on_values(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_freshness(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_commanded(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_status(const process::Drive&) override {}
  void on_alarm(const process::Drive&, alarms::AlarmKind) override {}
  void on_bus(std::size_t) override {}
  void on_plant_change(const process::PlantChange&) override {
    if (act_) {
      std::exchange(act_, nullptr)();
    }
  }

 private:
  process::Plant& plant_;
  std::function<void()> act_;
};

TEST_F(ReloadTest, OneThatIsToldToRunWhileASectionIsChangedWaits) {
  const process::Drive* const fan = &drive("fan1");
  file_.http.emplace().listen = {"127.0.0.1", 0};
  file_.drives[0].commands.lease = 5s;
  std::optional<support::Spawned<process::Outcome>> answer;
  AtChange at_change(gateway_.plant(), [&] {
    EXPECT_TRUE(in_use().http.has_value());
    EXPECT_EQ(&drive("fan1"), fan) << "the sections come first";
    std::vector<process::FieldWrite> run;
    for (const auto& [name, value] :
         {std::pair("frequency_command", 30.0), {"torque_command", 0.0}, {"control_command", 1.0}}) {
      run.push_back({static_cast<process::SignalId>(drive("fan1").model().find(name).value()), value});
    }
    answer = support::spawn(loop_.executor(),
                            drive("fan1").write({.writer = {.way = process::Writer::Way::local, .address = {}}}, run));
  });
  reload();
  ASSERT_TRUE(loop_.advance_until([&] { return answer && answer->done(); }, 5s));
  EXPECT_FALSE(answer->get().has_error()) << answer->get().error().detail;
  EXPECT_EQ(&drive("fan1"), fan);
  EXPECT_EQ(drive("fan1").pending_change(), "waits for standstill");
  EXPECT_TRUE(loop_.advance_until([&] { return drive("fan1").image().raw(running_of("fan1")) != 0; }, 5s));
}

TEST_F(ReloadTest, AtTheEndNothingIsBegunAnyMore) {
  file_.http.emplace().listen = {"127.0.0.1", 0};
  file_.mqtt.emplace().brokers = {{"127.0.0.1", 1}};
  file_.drives[0].commands.lease = 5s;
  std::shared_ptr<bool> stopped;
  AtChange at_change(gateway_.plant(), [&] { stopped = support::spawn(loop_.executor(), reload_.stop()); });
  reload_.request();
  await([&] { return stopped && *stopped; });
  EXPECT_TRUE(in_use().http.has_value());
  EXPECT_FALSE(in_use().mqtt.has_value());
  EXPECT_EQ(in_use().drives, model_.drives);
}

TEST_F(ReloadTest, ALoadThatThrowsIsOneWithErrors) {
  throws_ = true;
  reload();
  EXPECT_EQ(in_use(), model_);
}

// Of two drives with one node id nobody knows which one speaks.
TEST_F(ReloadTest, OneWhoseNodeIdIsDoubledWaitsButForWhatMendsIt) {
  simulator::DriveOptions options;
  options.serial = 77;
  const auto spare = simulator::make_drive(model_.drives[0].profile, model_.drives[0].node.node, network_, options);
  spare->power_on();
  ASSERT_TRUE(loop_.advance_until([&] { return drive("fan1").status().doubled != canopen::Doubled::no; }, 2min));
  ASSERT_TRUE(gateway_.plant().bus_alarm(0).active);
  const std::string alarm = gateway_.plant().bus_alarm(0).id;
  const process::Drive* const fan = &drive("fan1");
  file_.drives[0].commands.lease = 5s;
  reload();
  EXPECT_EQ(&drive("fan1"), fan);
  EXPECT_EQ(drive("fan1").pending_change(), "waits, as two drives have its node id");
  EXPECT_TRUE(gateway_.plant().bus_alarm(0).active);
  EXPECT_EQ(gateway_.plant().bus_alarm(0).id, alarm);
  file_.drives[0].node.node = 99;
  reload();
  EXPECT_EQ(drive("fan1").model().node.node, 99);
  EXPECT_EQ(drive("fan1").pending_change(), "");
}

/// A TCP port that nobody has.
std::uint16_t free_port(boost::asio::io_context& context) {
  using boost::asio::ip::tcp;
  return tcp::acceptor(context, tcp::endpoint(boost::asio::ip::address_v4::loopback(), 0)).local_endpoint().port();
}

TEST_F(ReloadTest, ANewModbusServerWaitsForNoCommandOfTheOld) {
  using boost::asio::ip::tcp;
  const std::uint16_t port = free_port(loop_.context());
  config::Modbus& modbus = file_.modbus.emplace();
  modbus.listen = {{"127.0.0.1", port}};
  file_.drives[0].commands.deadline = 30s;
  reload();
  loop_.advance(5s);
  drives_[0]->misbehaviour().sdo_delay = 25s;
  const auto connect = [&] {
    tcp::socket socket(loop_.context());
    socket.connect({boost::asio::ip::address_v4::loopback(), port});
    return socket;
  };
  // frequency_command alone goes by SDO.
  const process::Drive& fan = drive("fan1");
  const std::uint16_t address = fan.model().signals[fan.model().find("frequency_command").value()].modbus.address;
  const std::array<std::uint8_t, 12> write{0,
                                           1,
                                           0,
                                           0,
                                           0,
                                           6,
                                           fan.model().unit.value(),
                                           6,
                                           static_cast<std::uint8_t>(address >> 8U),
                                           static_cast<std::uint8_t>(address & 0xFFU),
                                           0,
                                           5};
  tcp::socket waits = connect();
  boost::asio::write(waits, boost::asio::buffer(write));
  loop_.advance(1s);
  modbus.max_clients = 3;
  reload();
  EXPECT_EQ(in_use().modbus->max_clients, 3U);
  tcp::socket next = connect();
  std::array<std::uint8_t, 12> read{0, 1, 0, 0, 0, 6, 0, 3, 0, 2, 0, 1};
  boost::asio::write(next, boost::asio::buffer(read));
  loop_.advance(100ms);
  EXPECT_EQ(next.available(), 11U) << "answered while the old write hangs";
  loop_.advance(5min);
  EXPECT_EQ(gateway_.plant().online(), 4U);
}

}  // namespace
}  // namespace gateway
