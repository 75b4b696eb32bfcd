#include "bridges/mqtt/publisher_settings.h"

#include "bridges/mqtt/topics.h"

namespace mqtt {
namespace {

int number_of(config::MqttVersion version) noexcept {
  switch (version) {
    case config::MqttVersion::v5:
      return 5;
    case config::MqttVersion::v3_1_1:
      return 4;
    case config::MqttVersion::automatic:
      break;
  }
  return 0;
}

}  // namespace

PublisherSettings publisher_settings(const config::Mqtt& mqtt, const config::Gateway& gateway) {
  PublisherSettings settings;
  settings.broker = mqtt.brokers.front();
  settings.version = number_of(mqtt.version);
  settings.client.client_id = mqtt.client_id.empty() ? "canopen-gateway-" + gateway.name : mqtt.client_id;
  settings.client.username = mqtt.username;
  settings.client.password = mqtt.password;
  settings.client.will_topic = status_topic(mqtt.base, gateway.name);
  settings.client.will_payload = "offline";
  settings.client.qos = mqtt.qos;
  return settings;
}

}  // namespace mqtt
