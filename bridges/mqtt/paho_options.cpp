#include "bridges/mqtt/paho_options.h"

#include <cstdint>
#include <utility>

namespace mqtt {
namespace {

constexpr int kWindow = static_cast<int>(BrokerLimits{}.window);
// Of ours that Paho may hold; our window stays below it, so it never refuses one.
constexpr int kPahoBuffer = kWindow * 2;
// Longest message we take, in bytes (MQTT 5 only): the broker drops longer ones.
constexpr std::int32_t kMaxIncoming = 128 * 1024;

std::int32_t seconds_of(std::chrono::seconds duration) {
  return static_cast<std::int32_t>(duration.count());
}

// TLS 1.2 at least: OpenSSL 3 has no older one at this security level.
ssl_options options_of(const TlsFiles& files) {
  ssl_options options;
  if (!files.ca.empty()) {
    options.set_trust_store(files.ca);
  }
  if (!files.cert.empty()) {
    options.set_key_store(files.cert);
    options.set_private_key(files.key);
  }
  options.set_enabled_cipher_suites(kTlsCiphers);
  options.set_enable_server_cert_auth(true);
  options.set_verify(true);  // that it is for the host of the URI
  return options;
}

}  // namespace

connect_options options_of(const ClientSettings& settings) {
  connect_options options;
  options.set_mqtt_version(settings.version);
  if (settings.version >= MQTTVERSION_5) {
    options.set_clean_start(true);
    options.set_properties({{property::SESSION_EXPIRY_INTERVAL, seconds_of(settings.session_expiry)},
                            {property::MAXIMUM_PACKET_SIZE, kMaxIncoming}});
  } else {
    options.set_clean_session(true);
  }
  options.set_automatic_reconnect(false);
  options.set_keep_alive_interval(settings.keep_alive);
  options.set_connect_timeout(settings.connect_timeout);
  options.set_max_inflight(kWindow);
  if (!settings.username.empty()) {
    options.set_user_name(settings.username);
    options.set_password(settings.password);
  }
  if (settings.uri.starts_with("ssl://")) {
    options.set_ssl(options_of(settings.tls));
  }
  will_options will(settings.will_topic, settings.will_payload, settings.qos, true);
  if (settings.version >= MQTTVERSION_5) {
    will.set_properties({{property::WILL_DELAY_INTERVAL, seconds_of(settings.will_delay)}});
  }
  options.set_will(std::move(will));
  return options;
}

subscribe_options options_of(const Subscription& subscription) {
  if (subscription.watched) {
    return subscribe_options(
        subscription.own_too ? subscribe_options::SUBSCRIBE_LOCAL : subscribe_options::SUBSCRIBE_NO_LOCAL,
        subscribe_options::NO_RETAIN_AS_PUBLISHED,
        subscription.kept ? subscribe_options::SEND_RETAINED_ON_SUBSCRIBE : subscribe_options::DONT_SEND_RETAINED);
  }
  return subscribe_options(subscribe_options::SUBSCRIBE_LOCAL, subscribe_options::RETAIN_AS_PUBLISHED);
}

create_options creation_of(const ClientSettings& settings) {
  create_options options(settings.version, kPahoBuffer);
  options.set_send_while_disconnected(false);
  options.set_restore_messages(false);
  options.set_persist_qos0(false);
  return options;
}

}  // namespace mqtt
