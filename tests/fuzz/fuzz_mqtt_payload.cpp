// Payloads of commands: whatever the bytes, a value or an error, and what was read is written
// and read again the same.

#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "bridges/mqtt/answers.h"
#include "bridges/mqtt/command.h"
#include "bridges/mqtt/topics.h"
#include "tests/unit/mqtt/site.h"

namespace {

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

void answer(const mqtt::Parsed& parsed, const canopen::Result<void>& outcome) {
  const mqtt::ReplyTo to{.topic = "r", .command_topic = "t", .id = parsed.id};
  const mqtt::Message message = mqtt::command_answer(to, outcome);
  const auto read = text::parse_flat(message.payload);
  require(read.has_value());  // every answer is JSON, whatever it quotes
}

void commands(std::string_view text) {
  static const config::Drive drive = mqtt::test::pump1();
  const mqtt::Parsed value = mqtt::parse_value(text);
  if (value.members.has_value()) {
    for (std::size_t signal = 0; signal < drive.signals.size(); ++signal) {
      const auto field = mqtt::field_of(drive, signal, value.members.value().front().second);
      answer(value, field.has_error() ? canopen::Result<void>(field.error()) : canopen::Result<void>());
    }
    (void)mqtt::nmt_command_of(value.members.value());
  } else {
    answer(value, value.members.error());
  }
  const mqtt::Parsed object = mqtt::parse_object_payload(text);
  if (object.members.has_value()) {
    const auto fields = mqtt::fields_of(drive, object.members.value());
    answer(object, fields.mistake ? canopen::Result<void>(*fields.mistake) : canopen::Result<void>());
    require(fields.mistake || fields.sound.size() == object.members.value().size());
    const auto request = mqtt::sdo_request_of(object.members.value());
    answer(object, request.has_error() ? canopen::Result<void>(request.error()) : canopen::Result<void>());
  }
}

void topics(std::string_view text) {
  static const config::Model model = mqtt::test::model();
  static const mqtt::Topics topics(model, config::Mqtt{}, "line3");
  (void)topics.route(text);
  const std::string below = "canopen/line3/" + std::string(text);
  (void)topics.route(below);
  require(topics.refused_as_response(below));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  commands(text);
  topics(text);
  return 0;
}
