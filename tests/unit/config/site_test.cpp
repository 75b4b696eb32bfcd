#include "tests/unit/config/site.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "config/toml/files.h"

namespace config {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;
using testing::HasSubstr;

TEST(Defaults, AreThoseOfTheManual) {
  const Model model = model_of(kBus + kDrive + "[modbus]\n[mqtt]\n");
  EXPECT_EQ(model.gateway.name, "host");
  ASSERT_EQ(model.buses.size(), 1U);
  EXPECT_EQ(model.buses[0].interface, "can0");
  EXPECT_EQ(model.buses[0].bitrate, std::nullopt);
  EXPECT_EQ(model.buses[0].node_id, 127);
  EXPECT_EQ(model.buses[0].heartbeat, milliseconds(500));
  EXPECT_EQ(model.buses[0].sync, canopen::Duration::zero());
  ASSERT_EQ(model.drives.size(), 1U);
  const Drive& drive = model.drives[0];
  EXPECT_EQ(drive.name, "pump1");
  EXPECT_EQ(drive.unit, 5);
  EXPECT_EQ(drive.node.node, 5);
  EXPECT_EQ(drive.node.gateway_node, 127);
  EXPECT_EQ(drive.node.error_control.heartbeat, milliseconds(500));
  EXPECT_EQ(drive.node.error_control.heartbeat_timeout, milliseconds(1500));
  EXPECT_EQ(drive.node.error_control.supervise_gateway, canopen::Duration::zero());
  EXPECT_FALSE(drive.node.reconfigure_running);
  EXPECT_EQ(drive.commands, Commands());
  EXPECT_EQ(drive.on_stale, OnStale::exception);
  EXPECT_EQ(model.modbus, Modbus());
  EXPECT_EQ(model.modbus->idle_timeout, minutes(10));
  EXPECT_EQ(model.mqtt, Mqtt());
  EXPECT_EQ(model.mqtt->max_interval, seconds(60));
}

TEST(Buses, SayWhatAnEchoProves) {
  using canopen::EchoProves;
  const auto echo_of = [](const std::string& word) {
    return model_of(kBus + "echo = \"" + word + "\"\n" + kDrive).buses.at(0).echo;
  };
  EXPECT_EQ(echo_of("auto"), EchoProves::by_driver);
  EXPECT_EQ(echo_of("departure"), EchoProves::departure);
  EXPECT_EQ(echo_of("adapter"), EchoProves::adapter);
  EXPECT_EQ(model_of(kBus + kDrive).buses.at(0).echo, EchoProves::by_driver);
}

TEST(Defaults, LeaveModbusAndMqttOff) {
  const Model model = model_of(kBus + kDrive);
  EXPECT_FALSE(model.modbus.has_value());
  EXPECT_FALSE(model.mqtt.has_value());
}

TEST(Gateway, SaysWhereItKeepsThings) {
  const Gateway standard = model_of(kBus + kDrive).gateway;
  EXPECT_EQ(standard.state_dir, "/var/lib/canopen-gateway");
  EXPECT_EQ(standard.control, "/run/canopen-gateway/control");
  EXPECT_EQ(standard.journal, 50'000'000U);
  const Gateway own =
      model_of("[gateway]\nstate_dir = \"/srv/a b\"\ncontrol = \"/tmp/c\"\njournal = \"1GB\"\n" + kBus + kDrive)
          .gateway;
  EXPECT_EQ(own.state_dir, "/srv/a b");
  EXPECT_EQ(own.control, "/tmp/c");
  EXPECT_EQ(own.journal, 1'000'000'000U);
  EXPECT_EQ(model_of("[gateway]\ncontrol = \"\"\n" + kBus + kDrive).gateway.control, "");
}

TEST(Gateway, HasASocketWhoseAddressHoldsItsPath) {
  const auto site = [](std::size_t length) {
    return "[gateway]\ncontrol = \"/" + std::string(length - 1, 'a') + "\"\n" + kBus + kDrive;
  };
  EXPECT_EQ(model_of(site(107)).gateway.control.size(), 107U);
  EXPECT_THAT(error_of(site(108)), HasSubstr("has 108 bytes; at most 107 are possible in the address of a socket"));
}

TEST(Gateway, TakesTheHostsNameWithoutItsDomain) {
  ProfileLibrary library({kProfiles});
  const LoadOptions options{.file = "gateway.toml", .profile_dirs = {}, .host_name = "plant 3.example.org"};
  EXPECT_EQ(load_text(kBus + kDrive, options, library).model.value_or(Model{}).gateway.name, "plant-3");
}

TEST(Gateway, NeedsANameWhereTheHostHasNone) {
  ProfileLibrary library({kProfiles});
  const LoadOptions options{.file = "gateway.toml", .profile_dirs = {}, .host_name = ""};
  EXPECT_THAT(lines(load_text(kBus + kDrive, options, library).findings), HasSubstr("[gateway] name"));
}

TEST(Buses, HaveNamesAndInterfacesOfTheirOwn) {
  const std::string two = "[[bus]]\nname = \"can0\"\n[[bus]]\nname = \"can1\"\ninterface = \"can0\"\n";
  EXPECT_THAT(error_of(two + kDrive + "bus = \"can1\"\n"),
              HasSubstr("5:13: error: bus \"can1\": interface \"can0\" is already that of bus \"can0\""));
  EXPECT_THAT(lines(load_site(kBus + kBus + kDrive + "bus = \"can0\"\n").findings),
              HasSubstr("4:8: error: bus \"can0\": there is another bus of this name"));
  EXPECT_THAT(error_of("[[bus]]\nname = \"a\"\ninterface = \"a-name-that-is-too-long\"\n" + kDrive),
              HasSubstr("is no interface name"));
  const Model model = model_of(
      "[[bus]]\nname = \"a\"\ninterface = \"virtual\"\n[[bus]]\nname = \"b\"\ninterface = "
      "\"virtual\"\n" +
      kDrive + "bus = \"b\"\n");
  EXPECT_EQ(model.drives.at(0).bus, 1U);
}

TEST(Buses, HaveALoadThatSdoMayLeadTo) {
  EXPECT_EQ(model_of(kBus + kDrive).buses.at(0).sdo_load, 0.7);
  EXPECT_EQ(model_of(kBus + "sdo_load = 1\n" + kDrive).buses.at(0).sdo_load, 1.0);
  EXPECT_THAT(error_of(kBus + "sdo_load = 70\n" + kDrive),
              HasSubstr("3:12: error: bus \"can0\": sdo_load 70 is out of range 0.1..1"));
}

TEST(Buses, MustBeNamedByADriveWhereThereAreSeveral) {
  const std::string two = "[[bus]]\nname = \"can0\"\n[[bus]]\nname = \"can1\"\n";
  EXPECT_THAT(error_of(two + kDrive), HasSubstr("5:1: error: drive \"pump1\": bus is missing"));
  EXPECT_THAT(error_of(two + kDrive + "bus = \"can2\"\n"), HasSubstr("bus \"can2\" is not among the buses"));
}

TEST(ModbusServer, TakesItsKeys) {
  const Model model = model_of(kBus + kDrive + R"([modbus]
listen = ["127.0.0.1:1502", "[::1]:1502"]
max_clients = 4
idle_timeout = "30s"
read_from = ["10.0.0.0/8"]
write_from = ["192.168.1.7", "fe80::/10"]
word_order = "little"
on_stale = "hold"
)");
  ASSERT_TRUE(model.modbus.has_value());
  EXPECT_EQ(model.modbus->listen, (std::vector<Endpoint>{{"127.0.0.1", 1502}, {"::1", 1502}}));
  EXPECT_EQ(model.modbus->max_clients, 4U);
  EXPECT_EQ(model.modbus->idle_timeout, seconds(30));
  EXPECT_EQ(model.modbus->read_from, (std::vector<Network>{{"10.0.0.0", 8}}));
  EXPECT_EQ(model.modbus->write_from, (std::vector<Network>{{"192.168.1.7", 32}, {"fe80::", 10}}));
  EXPECT_EQ(model.modbus->word_order, WordOrder::little);
  EXPECT_EQ(model.drives.at(0).on_stale, OnStale::hold);
}

TEST(ModbusServer, RefusesAddressesThatAreNone) {
  const std::string site = kBus + kDrive + "[modbus]\n";
  EXPECT_THAT(error_of(site + "listen = [\"0.0.0.0\"]\n"), HasSubstr("8:11: error: modbus.listen \"0.0.0.0\" must be"));
  EXPECT_THAT(error_of(site + "listen = [\"::1:502\"]\n"), HasSubstr("must be an address and a port"));
  EXPECT_THAT(error_of(site + "listen = [\"a:70000\"]\n"), HasSubstr("must be an address and a port"));
  EXPECT_THAT(error_of(site + "listen = []\n"), HasSubstr("modbus.listen is empty"));
  EXPECT_THAT(error_of(site + "listen = [\"[fe80::1]:502\"]\n"),
              HasSubstr("8:11: error: modbus.listen \"[fe80::1]:502\" is a link-local address"));
  for (const auto* const host : {"300.0.0.1", "192.168.1", "0x7f.1", "0x7f000001", "-", "a..b", "-a", "224.0.0.1",
                                 "255.255.255.255", "[::ffff:127.0.0.1]", "[fe80::1%eth0]", "[ff02::1]", "[1.2.3.4]"}) {
    EXPECT_THAT(error_of(site + "listen = [\"" + host + ":502\"]\n"), HasSubstr("must be an address and a port"))
        << host;
  }
  EXPECT_THAT(error_of(site + "listen = [\"0.0.0.0:502\", \"127.0.0.1:502\"]\n"),
              HasSubstr("8:26: error: modbus.listen \"127.0.0.1:502\" is contained in \"0.0.0.0:502\""));
  EXPECT_THAT(error_of(site + "listen = [\"127.0.0.1:502\", \"0.0.0.0:502\"]\n"), HasSubstr("8:11: error: "));
  EXPECT_THAT(error_of(site + "listen = [\"localhost:502\", \"127.0.0.1:502\"]\n"), HasSubstr("stands there twice"));
  EXPECT_THAT(error_of(site + "listen = [\"[::1]:502\", \"[0:0::1]:502\"]\n"), HasSubstr("stands there twice"));
  EXPECT_TRUE(load_site(site + "listen = [\"0.0.0.0:502\", \"[::]:502\", \"127.0.0.1:1502\", \"gw.plant.:502\"]\n")
                  .model.has_value());
  EXPECT_THAT(error_of(site + "write_from = [\"10.0.0.0/33\"]\n"), HasSubstr("must be a network"));
  EXPECT_THAT(error_of(site + "write_from = [\"plc.local\"]\n"), HasSubstr("must be a network"));
  EXPECT_THAT(error_of(site + "write_from = [\"192.168.1.7/24\"]\n"), HasSubstr("the network is \"192.168.1.0/24\""));
  EXPECT_THAT(error_of(site + "write_from = [\"10.0.0.0/08\"]\n"), HasSubstr("must be a network"));
  EXPECT_THAT(error_of(site + "read_from = [\"::ffff:192.168.1.0/120\"]\n"),
              HasSubstr("is IPv4 and must be written so: \"192.168.1.0/24\""));
  EXPECT_THAT(errors_of(load_site(site + "read_from = [\"192.168.0.0/16\"]\nwrite_from = [\"192.168.1.0/24\", "
                                         "\"y\"]\n")),
              testing::ElementsAre(HasSubstr("\"y\" must be a network")));
}

TEST(MqttClient, TakesItsKeysAndThePasswordFile) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "mqtt-password";
  std::ofstream(file) << "secret\n";
  std::filesystem::permissions(file, std::filesystem::perms::owner_read);
  const std::string site = kBus + kDrive +
                           "[mqtt]\nbrokers = [\"mqtt://broker.example:1884\"]\nbase = \"a/b\"\n"
                           "qos = 0\nstate = false\nsignals = false\nmin_interval = \"0s\"\nmax_interval = "
                           "\"10s\"\nusername = \"u\"\npassword_file = \"" +
                           file.string() + "\"\n";
  const LoadOptions with_secrets{
      .file = "gateway.toml", .profile_dirs = {kProfiles}, .host_name = "host", .with_secrets = true};
  const Model model = load_text(site, with_secrets).model.value_or(Model{});
  ASSERT_TRUE(model.mqtt.has_value());
  EXPECT_EQ(model.mqtt->brokers, (std::vector<Endpoint>{{"broker.example", 1884}}));
  EXPECT_EQ(model.mqtt->base, "a/b");
  EXPECT_EQ(model.mqtt->qos, 0);
  EXPECT_FALSE(model.mqtt->state);
  EXPECT_FALSE(model.mqtt->signals);
  EXPECT_EQ(model.mqtt->min_interval, canopen::Duration::zero());
  EXPECT_EQ(model.mqtt->username, "u");
  EXPECT_EQ(model.mqtt->password_file, file.string()) << "it is read when it is used";
}

TEST(MqttClient, TakesTheFilesOfTls) {
  const std::filesystem::path directory = std::filesystem::path(testing::TempDir()) / "mqtt-tls";
  std::filesystem::create_directories(directory / "credentials");
  for (const char* const file : {"ca.crt", "gw.crt", "gw.key", "credentials/gw.key"}) {
    std::ofstream(directory / file) << "PEM\n";
    std::filesystem::permissions(directory / file, std::filesystem::perms::owner_read);
  }
  const std::string tls = "[mqtt]\nbrokers = [\"mqtts://Broker.example:8883\"]\n";
  const std::string files = "ca_file = \"ca.crt\"\ncert_file = \"gw.crt\"\nkey_file = \"gw.key\"\n";
  const LoadOptions options{.file = directory / "gateway.toml", .profile_dirs = {kProfiles}, .host_name = "host"};
  Mqtt mqtt = load_text(kBus + kDrive + tls + files, options).model.value_or(Model{}).mqtt.value_or(Mqtt{});
  EXPECT_EQ(mqtt.brokers, (std::vector<Endpoint>{{"broker.example", 8883, true}}));
  EXPECT_EQ(mqtt.ca_file, (directory / "ca.crt").string());
  EXPECT_EQ(mqtt.cert_file, (directory / "gw.crt").string());
  EXPECT_EQ(mqtt.key_file, (directory / "gw.key").string());
  ASSERT_EQ(setenv("CREDENTIALS_DIRECTORY", (directory / "credentials").c_str(), 1), 0);
  mqtt = load_text(kBus + kDrive + tls + files, options).model.value_or(Model{}).mqtt.value_or(Mqtt{});
  unsetenv("CREDENTIALS_DIRECTORY");
  EXPECT_EQ(mqtt.key_file, (directory / "credentials/gw.key").string());
  EXPECT_EQ(mqtt.ca_file, (directory / "ca.crt").string()) << "which is no credential";
}

TEST(MqttClient, RefusesFilesOfTlsThatCannotWork) {
  const std::string site = kBus + kDrive + "[mqtt]\n";
  const std::string tls = site + "brokers = [\"mqtts://a:8883\"]\n";
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "tls-file";
  std::ofstream(file) << "PEM\n";
  std::filesystem::permissions(file, std::filesystem::perms::owner_read);
  const std::string is_file = " = \"" + file.string() + "\"\n";
  EXPECT_THAT(error_of(site + "ca_file" + is_file), HasSubstr("8:11: error: mqtt.ca_file is of use only with TLS"));
  EXPECT_THAT(errors_of(load_site(site + "brokers = [\"mqtts://a\"]\nca_file" + is_file)),
              testing::ElementsAre(HasSubstr("must be mqtt://HOST:PORT")))
      << "and nothing that follows of it";
  EXPECT_THAT(error_of(tls + "cert_file" + is_file), HasSubstr("9:13: error: mqtt.cert_file needs key_file"));
  EXPECT_THAT(error_of(tls + "key_file" + is_file), HasSubstr("9:12: error: mqtt.key_file needs cert_file"));
  EXPECT_THAT(error_of(tls + "ca_file = \"/nowhere/ca\"\n"),
              HasSubstr("9:11: error: mqtt.ca_file \"/nowhere/ca\" cannot be read: no such file"));
  std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::others_read);
  EXPECT_THAT(lines(load_site(tls + "cert_file" + is_file + "key_file" + is_file).findings),
              HasSubstr("10:12: warning: mqtt.key_file \"" + file.string() + "\" can be read by everybody"));
}

TEST(MqttClient, AFileThatMayBeACredentialOfTheServiceIsAWarningUntilItIsUsed) {
  const std::filesystem::path directory = std::filesystem::path(testing::TempDir()) / "mqtt-no-credentials";
  std::filesystem::create_directories(directory);
  LoadOptions options{.file = directory / "gateway.toml", .profile_dirs = {kProfiles}, .host_name = "host"};
  const std::string site = kBus + kDrive +
                           "[mqtt]\nbrokers = [\"mqtts://a:8883\"]\nusername = \"u\"\n"
                           "password_file = \"secret\"\nca_file = \"ca.crt\"\n";
  const Loaded checked = load_text(site, options);
  EXPECT_TRUE(checked.model.has_value());
  EXPECT_THAT(lines(checked.findings),
              HasSubstr("10:17: warning: mqtt.password_file \"secret\" is not beside the configuration; a credential"));
  EXPECT_THAT(lines(checked.findings), HasSubstr("11:11: warning: mqtt.ca_file \"ca.crt\" is not beside"));
  options.with_secrets = true;
  EXPECT_THAT(lines(load_text(site, options).findings),
              HasSubstr("10:17: error: mqtt.password_file \"secret\" cannot be read: no such file"));
  options.with_secrets = false;
  ASSERT_EQ(setenv("CREDENTIALS_DIRECTORY", directory.c_str(), 1), 0);
  const std::string in_the_service = lines(load_text(site, options).findings);
  unsetenv("CREDENTIALS_DIRECTORY");
  EXPECT_THAT(in_the_service, HasSubstr("10:17: error: mqtt.password_file \"secret\" cannot be read: no such file"));
}

TEST(MqttClient, RefusesTlsToAnIpv6AddressWhichNoCertificateCanBeFor) {
  const std::string site = kBus + kDrive + "[mqtt]\n";
  EXPECT_THAT(
      errors_of(load_site(site + "brokers = [\"mqtts://[2001:db8::1]:8883\"]\n")),
      testing::ElementsAre(HasSubstr("8:12: error: mqtt.brokers \"mqtts://[2001:db8::1]:8883\": mqtts:// needs a "
                                     "name or an IPv4 address; name the broker as its certificate does")));
  EXPECT_TRUE(load_site(site + "brokers = [\"mqtts://192.0.2.1:8883\"]\n").model.has_value());
  EXPECT_TRUE(load_site(site + "brokers = [\"mqtt://[2001:db8::1]:1883\"]\n").model.has_value());
}

TEST(MqttClient, ASecretIsNotForTheGroupOfOperators) {
  const std::filesystem::path directory = testing::TempDir();
  const std::filesystem::path secret = directory / "group-secret";
  const std::filesystem::path groups = directory / "groups";
  std::ofstream(secret) << "secret\n";
  const auto may_read = [&](std::filesystem::perms mode, const std::string& said) {
    std::filesystem::permissions(secret, mode);
    std::ofstream(groups) << "root:x:0:\nbroken\n" << said;
    return group_may_read(secret, "operators", groups);
  };
  using std::filesystem::perms;
  const std::string own = std::to_string(::getgid());
  const std::string other = std::to_string(::getgid() + 1);
  EXPECT_TRUE(may_read(perms::owner_read | perms::group_read, "operators:x:" + own + ":anna\n"));
  EXPECT_FALSE(may_read(perms::owner_read, "operators:x:" + own + ":anna\n"));
  EXPECT_FALSE(may_read(perms::owner_read | perms::group_read, "operators:x:" + other + ":anna\n"));
  EXPECT_FALSE(may_read(perms::owner_read | perms::group_read, "others:x:" + own + ":anna\n"));
  EXPECT_FALSE(group_may_read(directory / "none", "operators", groups));
}

TEST(MqttClient, LooksAtThePasswordFileWithoutReadingIt) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "looked-at-password";
  const std::string site = kBus + kDrive + "[mqtt]\nusername = \"u\"\npassword_file = \"" + file.string() + "\"\n";
  std::ofstream(file).flush();
  EXPECT_THAT(error_of(site), HasSubstr("is empty; its first line is the password"));
  std::ofstream(file) << "\nsecret\n";
  std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::others_read);
  const Loaded loaded = load_site(site);
  EXPECT_TRUE(loaded.model.has_value()) << "what stands in it is not looked at";
  EXPECT_THAT(lines(loaded.findings), HasSubstr("9:17: warning: mqtt.password_file"));
  EXPECT_THAT(lines(loaded.findings), HasSubstr("can be read by everybody on this machine"));
  const LoadOptions with_secrets{
      .file = "gateway.toml", .profile_dirs = {kProfiles}, .host_name = "host", .with_secrets = true};
  EXPECT_THAT(lines(load_text(site, with_secrets).findings), HasSubstr("begins with an empty line"));
}

TEST(MqttClient, RefusesWhatCannotWork) {
  const std::string site = kBus + kDrive + "[mqtt]\n";
  EXPECT_THAT(error_of(site + "username = \"u\"\npassword_file = \"/nowhere/p\"\n"),
              HasSubstr("9:17: error: mqtt.password_file \"/nowhere/p\" cannot be read: no such file"));
  EXPECT_THAT(error_of(site + "username = \"u\"\npassword_file = \"/dev/zero\"\n"),
              HasSubstr("not a file but a device"));
  EXPECT_THAT(lines(load_site(site + "password_file = \"/nowhere/p\"\n").findings), HasSubstr("needs username"));
  EXPECT_THAT(error_of(site + "brokers = [\"tcp://a:1883\"]\n"), HasSubstr("must be mqtt://HOST:PORT"));
  EXPECT_THAT(error_of(site + "brokers = [\"mqtt://u:p@a:1883\"]\n"), HasSubstr("must be mqtt://HOST:PORT"));
  EXPECT_THAT(error_of(site + "brokers = []\n"), HasSubstr("mqtt.brokers is empty"));
  EXPECT_THAT(error_of(site + "qos = 2\n"), HasSubstr("mqtt.qos 2 is out of range 0..1"));
  EXPECT_THAT(error_of(site + "base = \"a/+\"\n"), HasSubstr("must be a topic"));
  EXPECT_THAT(error_of(site + "base = \"\"\n"), HasSubstr("must be a topic"));
  EXPECT_THAT(error_of(site + "min_interval = \"2min\"\n"), HasSubstr("max_interval is shorter"));
}

TEST(Models, OfOneTextAreEqual) {
  const std::string text = kBus + kDrive + "[modbus]\n[mqtt]\n";
  EXPECT_EQ(model_of(text), model_of(text));
  EXPECT_NE(model_of(text), model_of(text + "[gateway]\nname = \"other\"\n"));
}

TEST(Summary, CountsInSingularAndPlural) {
  const std::string own = "title = \"t\"\n[signals.status_word]\nobject = \"0x6041\"\ntype = \"u16\"\n";
  const std::string one = kBus + "[[drive]]\nname = \"a\"\nnode = 1\nprofile = \"own\"\n";
  EXPECT_EQ(summary(model_of(one, own)), "ok: 1 bus, 1 drive, 1 signal");
  const std::string two =
      one + "bus = \"can0\"\n[[drive]]\nname = \"b\"\nnode = 2\nprofile = \"own\"\nbus = \"can0\"\n";
  EXPECT_EQ(summary(model_of(two + "[[bus]]\nname = \"can1\"\n", own)), "ok: 2 buses, 2 drives, 2 signals");
}

}  // namespace
}  // namespace config
