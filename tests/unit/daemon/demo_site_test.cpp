#include "daemon/demo_site.h"

#include <gmock/gmock.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "daemon/demo_name.h"
#include "tests/unit/daemon/demo_model.h"

namespace gateway {
namespace {

using config::Endpoint;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// A site with everything at the addresses of a plant, and a bus of one.
config::Model plant() {
  config::Model model = test::demo_model();
  model.gateway.name = "line3";
  model.buses.front().interface = "can0";
  model.modbus->listen = {{"0.0.0.0", 502}, {"192.0.2.7", 502}};
  model.modbus->write_from = {{"192.0.2.0", 24}};
  model.mqtt->brokers = {{"broker.plant.example", 8883, true}, {"192.0.2.9", 1883}};
  model.mqtt->client_id = "line3";
  model.mqtt->username = "line3";
  model.mqtt->password_file = "/etc/canopen-gateway/password";
  model.http->listen = {"0.0.0.0", 9464};
  return model;
}

config::Model demo_of(config::Model model, DemoOf of = DemoOf::given_site) {
  static_cast<void>(make_demo(model, of));
  return model;
}

TEST(DemoName, IsThatOfTheSiteAndSaysDemo) {
  EXPECT_EQ(demo_name("line3"), "line3-demo");
  EXPECT_EQ(demo_name("line3-demo"), "line3-demo-demo") << "a plant may be called that";
  EXPECT_EQ(demo_name("demo"), "demo-demo") << "and that";
}

TEST(DemoName, TakesThePlaceOfTheTailOfALongName) {
  EXPECT_EQ(demo_name("a23456789b123456789c123456789d12"), "a23456789b123456789c1234567-demo");
  EXPECT_EQ(demo_name("a23456789b123456789c1234567"), "a23456789b123456789c1234567-demo");
}

TEST(DemoName, IsNeverThatOfTheSite) {
  EXPECT_EQ(demo_name("a23456789b123456789c1234567-demo"), "a23456789b123456789c123456-demo");
}

// A plant, a rig or a machine may be called that.
TEST(DemoSite, ASiteThatIsCalledDemoIsNotTheDemo) {
  config::Model model = plant();
  model.gateway.name = "demo";
  model.mqtt->client_id = "demo";
  const config::Model demo = demo_of(std::move(model));
  EXPECT_EQ(demo.gateway.name, "demo-demo");
  EXPECT_EQ(demo.mqtt->client_id, "demo-demo");
}

TEST(DemoSite, IsOnLoopbackAndNeverAtThePortsOfAPlant) {
  const config::Model demo = demo_of(plant());
  EXPECT_EQ(demo.gateway.name, "line3-demo");
  EXPECT_THAT(demo.modbus->listen, ElementsAre(Endpoint{"127.0.0.1", 1502}));
  EXPECT_EQ(demo.modbus->write_from, config::Modbus{}.write_from);
  EXPECT_EQ(demo.modbus->read_from, config::Modbus{}.write_from);
  EXPECT_EQ(demo.http->listen, (Endpoint{"127.0.0.1", 9465}));
}

TEST(DemoSite, LeavesThePlantsBrokersAlone) {
  const config::Model demo = demo_of(plant());
  EXPECT_THAT(demo.mqtt->brokers, ElementsAre(Endpoint{"127.0.0.1", 1883}));
  EXPECT_EQ(demo.mqtt->client_id, "line3-demo");
  EXPECT_EQ(demo.mqtt->username, "");
  EXPECT_EQ(demo.mqtt->password_file, "");
}

TEST(DemoSite, KeepsALoopbackBrokerAndWhatItWants) {
  config::Model model = plant();
  model.mqtt->brokers.push_back({"::1", 1885});
  const config::Model demo = demo_of(std::move(model));
  EXPECT_THAT(demo.mqtt->brokers, ElementsAre(Endpoint{"::1", 1885}));
  EXPECT_EQ(demo.mqtt->username, "line3");
}

// What reads the plant at a port of this machine would read the demo there while the gateway is stopped.
TEST(DemoSite, IsNotWhereThisMachineFindsThePlant) {
  config::Model model = plant();
  model.modbus->listen = {{"127.0.0.1", 15020}, {"127.0.0.1", 1502}, {"0.0.0.0", 1503}};
  model.http->listen = {"127.0.0.1", 9465};
  const config::Model demo = demo_of(std::move(model));
  EXPECT_THAT(demo.modbus->listen, ElementsAre(Endpoint{"127.0.0.1", 1504}));
  EXPECT_EQ(demo.http->listen, (Endpoint{"127.0.0.1", 9466}));
}

TEST(DemoSite, StepsPastThePortsOfThePlant) {
  boost::asio::io_context unused;
  boost::asio::ip::tcp::acceptor taken(unused, {boost::asio::ip::make_address("127.0.0.1"), 0});
  const std::uint16_t port = taken.local_endpoint().port();
  config::Model model = test::demo_model();
  model.http->listen.port = port;
  model.modbus.reset();
  const Ports plant{static_cast<std::uint16_t>(port + 1), static_cast<std::uint16_t>(port + 2)};
  EXPECT_THAT(step_aside(model, plant), SizeIs(1));
  EXPECT_GT(model.http->listen.port, port + 2);
}

// Nothing but simulated drives can be on its buses.
TEST(DemoSite, KeepsTheLoopbackPortsOfASiteOnVirtualBuses) {
  config::Model model = plant();
  model.buses.front().interface = config::kVirtualInterface;
  model.modbus->listen = {{"127.0.0.1", 15020}, {"127.0.0.1", 502}};
  model.http->listen = {"::1", 18080};
  const config::Model demo = demo_of(std::move(model));
  EXPECT_THAT(demo.modbus->listen, ElementsAre(Endpoint{"127.0.0.1", 15020}, Endpoint{"127.0.0.1", 1502}));
  EXPECT_EQ(demo.http->listen, (Endpoint{"::1", 18080}));
}

TEST(DemoSite, HasEachAddressOnce) {
  config::Model model = plant();
  model.buses.front().interface = config::kVirtualInterface;
  model.modbus->listen = {{"192.0.2.7", 502}, {"127.0.0.1", 9465}, {"192.0.2.8", 502}};
  Ports ports = make_demo(model, DemoOf::given_site);
  EXPECT_THAT(model.modbus->listen, ElementsAre(Endpoint{"127.0.0.1", 1502}, Endpoint{"127.0.0.1", 9465}));
  static_cast<void>(step_aside(model, ports));
  EXPECT_NE(model.modbus->listen.back(), model.http->listen) << "the page has that port";
}

// The broker of this machine may be the plant's.
TEST(DemoSite, AnnouncesNoDevicesToThePlantsHomeAssistant) {
  config::Model model = plant();
  model.mqtt->home_assistant = "homeassistant";
  EXPECT_EQ(demo_of(std::move(model)).mqtt->home_assistant, "");
}

TEST(DemoSite, HasThePageWhateverTheSiteSays) {
  config::Model model = plant();
  model.http.reset();
  model.modbus.reset();
  model.mqtt.reset();
  const config::Model demo = demo_of(std::move(model));
  EXPECT_EQ(demo.http.value().listen, (Endpoint{"127.0.0.1", 9465}));
  EXPECT_FALSE(demo.modbus.has_value());
  EXPECT_FALSE(demo.mqtt.has_value());
}

TEST(DemoSite, ItsOwnConfigurationStaysAsItIs) {
  config::Model wanted = test::demo_model();
  wanted.modbus->read_from = config::Modbus{}.write_from;
  EXPECT_EQ(demo_of(test::demo_model(), DemoOf::itself), wanted);
}

TEST(DemoSite, GoesToTheNextFreePort) {
  boost::asio::io_context unused;
  boost::asio::ip::tcp::acceptor taken(unused, {boost::asio::ip::make_address("127.0.0.1"), 0});
  config::Model model = test::demo_model();
  model.http->listen.port = taken.local_endpoint().port();
  model.modbus.reset();
  const std::vector<std::string> told = step_aside(model, {});
  EXPECT_GT(model.http->listen.port, taken.local_endpoint().port());
  EXPECT_THAT(told, ElementsAre(HasSubstr("Port " + std::to_string(taken.local_endpoint().port()) +
                                          " is taken, by another demo or gateway perhaps: the page is on port " +
                                          std::to_string(model.http->listen.port))));
  EXPECT_THAT(step_aside(model, {}), IsEmpty());
}

}  // namespace
}  // namespace gateway
