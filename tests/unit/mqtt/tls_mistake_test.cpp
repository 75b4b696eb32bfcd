// The search for the cause why TLS fails, without a publisher.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <openssl/crypto.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "bridges/mqtt/tls_handshake.h"
#include "tests/support/certificates.h"
#include "tests/unit/mqtt/first_words.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::FirstWords;

constexpr const char* kSilent = "does not answer the handshake; it may hang or be starting";

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

config::Endpoint broker_at(std::uint16_t port) {
  return {.host = "localhost", .port = port, .tls = true};
}

TEST(TlsMistake, APortThatOnlyFallsSilentIsNoReasonToGoWithoutTls) {
  const FirstWords silent;
  const std::string mistake = tls_mistake(broker_at(silent.port()), {"127.0.0.1"}, {}, 200ms);
  EXPECT_TRUE(says(mistake, kSilent)) << mistake;
  EXPECT_FALSE(says(mistake, "mqtt://")) << mistake;
}

// As Paho does it.
TEST(TlsMistake, TheCauseIsLookedForAtIpv4AddressesFirst) {
  const FirstWords six("::1");
  const FirstWords four("127.0.0.1", six.port());
  (void)tls_mistake(broker_at(six.port()), {"::1", "127.0.0.1"}, {}, 200ms);
  EXPECT_TRUE(four.has_client());
  EXPECT_FALSE(six.has_client());
}

TEST(TlsMistake, AnAddressThatNobodyAnswersAtLeavesTimeForTheNext) {
  FirstWords full;
  ASSERT_TRUE(full.fill());
  EXPECT_EQ(tls_mistake(broker_at(full.port()), {"127.0.0.1"}, {}, 200ms), "");
  const FirstWords next("127.0.0.2", full.port());
  const std::string mistake = tls_mistake(broker_at(full.port()), {"127.0.0.1", "127.0.0.2"}, {}, 600ms);
  EXPECT_TRUE(says(mistake, kSilent)) << mistake;
}

/// Serves one client. With TLS 1.3 that takes the handshake for done before its certificate is looked at. One that
/// refuses wants a certificate, and says so then; the other says nothing more.
class Judge {
 public:
  Judge(const support::Certificate& own, bool refuses) {
    thread_ = std::thread([this, own, refuses] {
      const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(SSL_CTX_new(TLS_server_method()), &SSL_CTX_free);
      SSL_CTX_use_certificate_file(context.get(), own.cert.c_str(), SSL_FILETYPE_PEM);
      SSL_CTX_use_PrivateKey_file(context.get(), own.key.c_str(), SSL_FILETYPE_PEM);
      SSL_CTX_set_verify(context.get(), refuses ? SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT : SSL_VERIFY_NONE,
                         nullptr);
      const std::unique_ptr<SSL, decltype(&SSL_free)> session(SSL_new(context.get()), &SSL_free);
      const int client = port_.take();
      SSL_set_fd(session.get(), client);
      fcntl(client, F_SETFL, fcntl(client, F_GETFL) | O_NONBLOCK);
      for (int words = 0; words < 2; ++words) {
        wait_for_words_of(client);
        SSL_accept(session.get());
      }
      wait_for_words_of(client);  // Until it goes.
      close(client);
    });
  }
  ~Judge() { thread_.join(); }
  Judge(const Judge&) = delete;
  Judge& operator=(const Judge&) = delete;
  [[nodiscard]] std::uint16_t port() const { return port_.port(); }

 private:
  static void wait_for_words_of(int client) {
    pollfd wait{client, POLLIN, 0};
    poll(&wait, 1, 10'000);
  }

  FirstWords port_;
  std::thread thread_;
};

class TlsJudged : public testing::Test {
 protected:
  TlsJudged() {
    if (mkdtemp(name_.data()) == nullptr) {
      throw std::runtime_error("no directory");
    }
    ours_ = std::make_unique<support::Authority>(name_, "ours");
  }
  ~TlsJudged() override { std::filesystem::remove_all(name_); }

  std::string judged_by(bool refuses, std::chrono::milliseconds patience) {
    const Judge judge(ours_->issue("broker", "DNS:localhost"), refuses);
    return tls_mistake(broker_at(judge.port()), {"127.0.0.1"}, {.ca = ours_->file().string()}, patience);
  }

 private:
  std::string name_ = (std::filesystem::temp_directory_path() / "tls-mistake-XXXXXX").string();
  std::unique_ptr<support::Authority> ours_;
};

TEST_F(TlsJudged, ABrokerThatRefusesBehindTheHandshakeIsHeard) {
  const std::string mistake = judged_by(true, 10s);
  EXPECT_TRUE(says(mistake, "the broker wants a client certificate")) << mistake;
}

TEST_F(TlsJudged, ARefusalIsWaitedForAsLongAsThereIsTime) {
  constexpr auto kPatience = 1200ms;
  const auto begun = std::chrono::steady_clock::now();
  EXPECT_EQ(judged_by(false, kPatience), "") << "a broker that waits for the CONNECT has nothing against us";
  EXPECT_GE(std::chrono::steady_clock::now() - begun, kPatience);
}

TEST(TlsMistake, FilesThatAreMissingAreToldInTheSystemsWords) {
  std::string name = (std::filesystem::temp_directory_path() / "tls-mistake-XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  const support::Authority ours(name, "ours");
  const support::Certificate client = ours.issue("client", "DNS:line3");
  const std::string none = name + "/missing";
  const std::string said = none + " cannot be read: No such file or directory; it must be there";
  EXPECT_EQ(tls_files_mistake({.ca = none}).find("ca_file " + said), 0U) << tls_files_mistake({.ca = none});
  EXPECT_EQ(tls_files_mistake({.cert = none, .key = client.key.string()}).find("cert_file " + said), 0U);
  EXPECT_EQ(tls_files_mistake({.cert = client.cert.string(), .key = none}).find("key_file " + said), 0U);
  EXPECT_EQ(tls_files_mistake({.cert = client.cert.string(), .key = client.key.string()}), "");
  std::filesystem::remove_all(name);
}

// In a process of its own, in which nobody used OpenSSL before.
TEST(TlsAtTheEndDeathTest, NothingIsTakenFromThreadsThatShakeHandsStill) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        keep_tls_until_the_end();
        const bool noted = OPENSSL_atexit([] { _exit(1); }) == 1;
        (void)tls_files_mistake({});
        std::exit(noted ? 0 : 2);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace mqtt
