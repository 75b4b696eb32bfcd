// The real publisher and a real mosquitto over TLS, with certificates made for each test.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>

#include "bridges/mqtt/reach.h"
#include "tests/support/certificates.h"
#include "tests/support/mosquitto.h"
#include "tests/unit/mqtt/first_words.h"
#include "tests/unit/mqtt/publisher_fixture.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using support::Authority;
using support::Certificate;

class TlsTest : public test::PublisherFixture {
 public:
  void on_no_connection(const std::string& why) override { failures.push_back(why); }

 protected:
  TlsTest() {
    std::string name = (std::filesystem::temp_directory_path() / "mqtt-tls-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error("no directory for certificates");
    }
    directory = name;
    ours = std::make_unique<Authority>(directory, "ours");
  }
  ~TlsTest() override {
    publisher.reset();
    broker.reset();
    std::error_code ignored;
    std::filesystem::remove_all(directory, ignored);
  }

  /// A broker with this certificate; `wants_client`: one of a client signed by our authority, too.
  void serve(const Certificate& certificate, bool wants_client = false, const std::string& extra = {}) {
    broker = std::make_unique<support::Mosquitto>(
        "certfile " + certificate.cert.string() + "\nkeyfile " + certificate.key.string() + "\n" +
        (wants_client ? "cafile " + ours->file().string() + "\nrequire_certificate true\n" : "") + extra);
    ASSERT_TRUE(broker->start());
  }
  [[nodiscard]] PublisherSettings tls_settings(const std::string& host = "localhost") const {
    PublisherSettings made = settings(broker->port());
    made.brokers.front().host = host;
    made.brokers.front().tls = true;
    made.client.tls.ca = ours->file().string();
    return made;
  }
  [[nodiscard]] bool is_said(const std::string& part) const {
    return std::ranges::any_of(notices, [&part](const auto& text) { return text.find(part) != std::string::npos; });
  }
  void open() { publisher->open(connections.back()); }
  /// No connection, its cause in the log and told to the bridge, within the 10 s that are promised.
  /// `told`: to the bridge, where it is not the cause as it is.
  void expect_mistake(PublisherSettings made, const std::string& cause, const std::string& remedy,
                      const std::string& told = {}) {
    const std::string health = told.empty() ? cause : told;
    make(std::move(made));
    EXPECT_TRUE(run_until([&] { return is_said(cause); }, 10s)) << cause;
    EXPECT_TRUE(is_said(remedy)) << testing::PrintToString(notices);
    EXPECT_TRUE(run_until([&] { return !failures.empty() && failures.back().find(health) != std::string::npos; }, 5s))
        << "for B/health";
    EXPECT_EQ(failures.back().find(directory.string()), std::string::npos) << "where files lie is for the log alone";
    EXPECT_TRUE(connections.empty());
    const std::size_t lines = notices.size();
    EXPECT_TRUE(run_until([&] { return failures.size() > 2; })) << "it is tried again";
    EXPECT_EQ(notices.size(), lines) << "said once: " << testing::PrintToString(notices);
    EXPECT_TRUE(connections.empty());
  }

  std::filesystem::path directory;
  std::unique_ptr<Authority> ours;
  std::unique_ptr<support::Mosquitto> broker;
  std::vector<std::string> failures;
};

TEST_F(TlsTest, ConnectsByNameAndPublishes) {
  serve(ours->issue("broker", "DNS:localhost"));
  make(tls_settings());
  ASSERT_TRUE(connected()) << testing::PrintToString(notices);
  EXPECT_TRUE(is_said("MQTT 5, TLS"));
  ASSERT_TRUE(subscribe({{"a", 1}}));
  open();
  publisher->publish({{.topic = "a", .payload = "1"}});
  EXPECT_TRUE(run_until([this] { return has_message("a"); }));
  EXPECT_TRUE(failures.empty());
}

TEST_F(TlsTest, ABrokerIsLookedForAndTriedThroughTls) {
  serve(ours->issue("broker", "DNS:localhost"), true);
  const config::Endpoint at{.host = "localhost", .port = broker->port(), .tls = true};
  const Certificate client = ours->issue("client", "DNS:line3");
  const TlsFiles files{.ca = ours->file().string(), .cert = client.cert.string(), .key = client.key.string()};
  const TlsFiles without{.ca = ours->file().string()};
  const ClientSettings us{.client_id = "line3", .tls = files};
  EXPECT_TRUE(reaches(at, {"127.0.0.1"}, files, 5s).good);
  EXPECT_EQ(reaches(at, {"127.0.0.1"}, files, 5s).manner, Manner::connack);
  const config::Endpoint plainly{.host = "localhost", .port = broker->port()};
  EXPECT_NE(reaches(plainly, {"127.0.0.1"}, {}, 5s).manner, Manner::connack);
  EXPECT_TRUE(speaks_tls(plainly, {"127.0.0.1"}, 5s));
  const Reach trial = takes_us(at, {"127.0.0.1"}, us, 0, 5s);
  EXPECT_TRUE(trial.good) << trial.why;
  const Reach refused = takes_us(at, {"127.0.0.1"}, {.client_id = "line3", .tls = without}, 0, 5s);
  EXPECT_FALSE(refused.good) << "it refuses behind the handshake";
  EXPECT_FALSE(refused.why.empty());
  broker->freeze();
  EXPECT_FALSE(reaches(at, {"127.0.0.1"}, files, 300ms).good);
  EXPECT_FALSE(takes_us(at, {"127.0.0.1"}, us, 5, 300ms).good);
  broker->resume();
}

TEST_F(TlsTest, ConnectsByAddressWhereTheCertificateNamesIt) {
  serve(ours->issue("broker", "IP:127.0.0.1"));
  make(tls_settings("127.0.0.1"));
  EXPECT_TRUE(connected()) << testing::PrintToString(notices);
}

TEST_F(TlsTest, ConnectsWithAClientCertificate) {
  serve(ours->issue("broker", "DNS:localhost"), true);
  const Certificate client = ours->issue("client", "DNS:line3");
  PublisherSettings made = tls_settings();
  made.client.tls.cert = client.cert.string();
  made.client.tls.key = client.key.string();
  make(std::move(made));
  EXPECT_TRUE(connected()) << testing::PrintToString(notices);
}

TEST_F(TlsTest, TellsTheBrokerTheName) {
  const test::FirstWords broker_port;
  PublisherSettings made = settings(broker_port.port());
  made.brokers.front().host = "localhost";
  made.brokers.front().tls = true;
  make(std::move(made));
  const std::string hello = broker_port.hear();
  ASSERT_FALSE(hello.empty());
  EXPECT_EQ(hello.front(), '\x16') << "a handshake record (RFC 8446 §5.1)";
  EXPECT_NE(hello.find("localhost"), std::string::npos) << "SNI (RFC 6066 §3)";
}

TEST_F(TlsTest, ABrokerOfAnotherAuthorityIsRefused) {
  const Authority others(directory, "others");
  serve(others.issue("broker", "DNS:localhost"));
  expect_mistake(tls_settings(), "not signed by an authority that ca_file names",
                 "take the certificate of the broker's authority");
}

TEST_F(TlsTest, ABrokerThatTheSystemDoesNotKnowIsRefused) {
  serve(ours->issue("broker", "DNS:localhost"));
  PublisherSettings made = tls_settings();
  made.client.tls.ca.clear();
  expect_mistake(std::move(made), "not signed by an authority that this system trusts",
                 "give the authority's certificate as ca_file");
}

TEST_F(TlsTest, ABrokerOfAnotherNameIsRefused) {
  serve(ours->issue("broker", "DNS:other.example"));
  expect_mistake(tls_settings(), "is not for localhost", "name the broker in `brokers` as its certificate does");
}

TEST_F(TlsTest, ABrokerOfAnotherAddressIsRefused) {
  serve(ours->issue("broker", "IP:127.0.0.2,DNS:localhost"));
  expect_mistake(tls_settings("127.0.0.1"), "is not for 127.0.0.1", "name the broker");
}

TEST_F(TlsTest, ACertificateThatExpiredIsRefused) {
  serve(ours->issue("broker", "DNS:localhost", {-2h, -1h}));
  expect_mistake(tls_settings(), "certificate has expired", "renew it at the broker");
}

TEST_F(TlsTest, AnAuthorityThatExpiredIsToldFromTheBrokersCertificate) {
  const Authority old(directory, "old", -2h, -1h);
  serve(old.issue("broker", "DNS:localhost"));
  PublisherSettings made = tls_settings();
  made.client.tls.ca = old.file().string();
  expect_mistake(std::move(made), "the certificate of the broker's authority has expired", "the new one as ca_file");
}

TEST_F(TlsTest, ACertificateOfTheFutureIsRefused) {
  serve(ours->issue("broker", "DNS:localhost", {1h, 2h}));
  expect_mistake(tls_settings(), "is not valid yet", "set this machine's clock");
}

TEST_F(TlsTest, ABrokerThatWantsAClientCertificateSaysSo) {
  serve(ours->issue("broker", "DNS:localhost"), true);
  expect_mistake(tls_settings(), "the broker wants a client certificate", "give cert_file and key_file");
}

TEST_F(TlsTest, AClientCertificateThatTheBrokerRefusesIsNamed) {
  const Authority others(directory, "others");
  const Certificate client = others.issue("client", "DNS:line3");
  serve(ours->issue("broker", "DNS:localhost"), true);
  PublisherSettings made = tls_settings();
  made.client.tls.cert = client.cert.string();
  made.client.tls.key = client.key.string();
  expect_mistake(std::move(made), "the broker refuses the client certificate " + client.cert.string(),
                 "have it signed by the authority that the broker trusts", "refuses the client certificate; have");
}

TEST_F(TlsTest, APortWithoutTlsIsNamed) {
  broker = std::make_unique<support::Mosquitto>();
  ASSERT_TRUE(broker->start());
  expect_mistake(tls_settings(), "TLS: the connection is closed in the handshake", "not its TLS port");
  EXPECT_FALSE(is_said("mqtt://")) << "it may be a broker that is starting";
}

TEST_F(TlsTest, OfAPortWithTlsWithoutMqttsNothingIsTaken) {
  serve(ours->issue("broker", "DNS:localhost"));
  PublisherSettings made = tls_settings();
  made.brokers.front().tls = false;
  make(std::move(made));
  EXPECT_TRUE(run_until([this] { return !notices.empty(); }, 10s));
  EXPECT_TRUE(connections.empty());
}

TEST_F(TlsTest, FilesThatCannotBeUsedAreNamed) {
  serve(ours->issue("broker", "DNS:localhost"));
  const Certificate client = ours->issue("client", "DNS:line3");
  const Certificate another = ours->issue("another", "DNS:line3");
  PublisherSettings made = tls_settings();
  made.client.tls.cert = client.cert.string();
  made.client.tls.key = another.key.string();
  expect_mistake(made, "key_file " + another.key.string() + " cannot be used", "it must be the PEM key of cert_file",
                 "key_file cannot be used");
  made.client.tls.ca = (directory / "broken.crt").string();
  std::ofstream(directory / "broken.crt") << "no PEM\n";
  failures.clear();
  notices.clear();
  expect_mistake(std::move(made), "broken.crt cannot be used", "it must hold PEM certificates",
                 "ca_file cannot be used");
}

TEST_F(TlsTest, AKeyWithAPasswordIsNamedAndNobodyIsAsked) {
  serve(ours->issue("broker", "DNS:localhost"));
  const Certificate client = ours->issue("client", "DNS:line3", std::string("secret"));
  PublisherSettings made = tls_settings();
  made.client.tls.cert = client.cert.string();
  made.client.tls.key = client.key.string();
  expect_mistake(std::move(made), "it is protected by a password", "store it without one");
}

TEST_F(TlsTest, ACertificateRotatedOnDiskIsUsedAtTheNextConnection) {
  const Authority others(directory, "others");
  serve(ours->issue("broker", "DNS:localhost"), true);
  const Certificate client = others.issue("client", "DNS:line3");
  PublisherSettings made = tls_settings();
  made.client.tls.cert = client.cert.string();
  made.client.tls.key = client.key.string();
  make(std::move(made));
  ASSERT_TRUE(run_until([this] { return is_said("refuses the client certificate"); }, 10s));
  (void)ours->issue("client", "DNS:line3");
  EXPECT_TRUE(connected()) << testing::PrintToString(notices);
}

TEST_F(TlsTest, ThePasswordIsReadAtEachConnectionAndNeverSaid) {
  std::ofstream(directory / "users") << "gateway:right\n";
  ASSERT_EQ(std::system(("mosquitto_passwd -U " + (directory / "users").string()).c_str()), 0);
  serve(ours->issue("broker", "DNS:localhost"), false,
        "allow_anonymous false\npassword_file " + (directory / "users").string() + "\n");
  const std::filesystem::path file = directory / "password";
  PublisherSettings made = tls_settings();
  made.client.username = "gateway";
  made.password_file = file.string();
  make(std::move(made));
  ASSERT_TRUE(run_until([this] { return is_said("password_file"); }, 10s)) << "there is none";
  std::ofstream(file) << "wrong-secret\n";
  ASSERT_TRUE(run_until([this] { return is_said("authorized"); }, 10s)) << testing::PrintToString(notices);
  std::ofstream(file) << "right\n";
  EXPECT_TRUE(connected());
  EXPECT_FALSE(is_said("wrong-secret"));
}

}  // namespace
}  // namespace mqtt
