#pragma once

#include <string>
#include <utility>

#include "bridges/mqtt/message.h"

namespace mqtt::test {

inline Message value(std::string topic, std::string payload) {
  return {.topic = std::move(topic), .payload = std::move(payload)};
}
inline Message alarm(std::string topic, std::string payload) {
  return {.topic = std::move(topic), .payload = std::move(payload), .kind = MessageKind::alarm};
}
inline Message status(std::string topic, std::string payload, bool after_all = false) {
  return {
      .topic = std::move(topic), .payload = std::move(payload), .kind = MessageKind::status, .after_all = after_all};
}
inline Message answer(std::string payload) {
  return {.topic = "reply", .payload = std::move(payload), .kind = MessageKind::answer, .retained = false};
}

}  // namespace mqtt::test
