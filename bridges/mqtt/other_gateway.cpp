#include "bridges/mqtt/other_gateway.h"

#include <algorithm>
#include <boost/json/parse.hpp>
#include <string_view>
#include <utility>

#include "bridges/mqtt/expiry.h"

namespace mqtt {
namespace {

namespace json = boost::json;

// Of a message; with MQTT 5 no broker sends longer ones.
constexpr std::size_t kMostBytes = 128UL * 1024;
constexpr std::size_t kMostDepth = 8;
// Of what is shown of it.
constexpr std::size_t kMostLetters = 64;

std::string word_of(const json::object& object, std::string_view name) {
  const json::value* const found = object.if_contains(name);
  const json::string* const text = found == nullptr ? nullptr : found->if_string();
  return text == nullptr || text->size() > kMostLetters ? std::string() : std::string(text->data(), text->size());
}

bool is_word(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char letter) {
    return (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
           letter == '-';
  });
}

}  // namespace

std::optional<OtherGateway::Sign> OtherGateway::sign_of(const std::string& payload) {
  if (payload.size() > kMostBytes) {
    return std::nullopt;
  }
  json::error_code failure;
  json::parse_options options;
  options.max_depth = kMostDepth;
  const json::value read = json::parse(payload, failure, {}, options);
  if (failure || !read.is_object()) {
    return std::nullopt;
  }
  Sign sign{.instance = word_of(read.get_object(), "instance"), .ts = word_of(read.get_object(), "ts")};
  return is_word(sign.instance) ? std::optional(std::move(sign)) : std::nullopt;
}

void OtherGateway::connected(const std::string& broker) {
  broker_ = broker;
  first_ = !before_.contains(broker);
}

void OtherGateway::listening(canopen::TimePoint now) {
  listening_ = true;
  before_.emplace(broker_, std::nullopt);
  until_ = now + lifetime(settings_);
}

void OtherGateway::lost() {
  listening_ = false;
}

bool OtherGateway::heard(const Incoming& message, canopen::TimePoint now) {
  const std::optional<Sign> sign = sign_of(message.payload);
  if (!sign || sign->instance == instance_) {
    return false;
  }
  const auto kept = before_.find(broker_);
  const Sign* const before = kept != before_.end() && kept->second ? &*kept->second : nullptr;
  // Times of one instance are those of one clock, written in one way (RFC 3339). A bridge between brokers may bring
  // what is that old again, and `B/info` of the same life, which tells no time.
  if (before != nullptr && before->instance == sign->instance && sign->ts <= before->ts) {
    return false;
  }
  if (!message.retained) {
    beside_ = sign->instance;
    note(sign->instance, "it publishes on " + message.topic, now);
    return false;
  }
  if (sign->ts.empty()) {
    return false;  // `B/info`, which MQTT 3.1.1 brings too; `B/health` comes beside it
  }
  // What is older was there before: the broker lost what came later. Another gateway whose clock is late shows the next
  // time.
  if (first_ || (before != nullptr && sign->ts < before->ts)) {
    before_[broker_] = sign;
    return false;
  }
  note(sign->instance, "it published on " + message.topic + " while we had no connection, perhaps by our client id",
       now);
  return sign->instance != beside_;
}

void OtherGateway::took_over(canopen::TimePoint now) {
  note(who_.value_or(kUnknown), "its client has taken over our client id", now);
}

void OtherGateway::note(const std::string& instance, const std::string& how, canopen::TimePoint now) {
  until_ = now + lifetime(settings_);
  const bool begins = !who_;
  const bool changes = who_ != instance;
  who_ = instance;
  if (begins) {
    notice_(Level::error,
            "MQTT: another gateway of our name lives, instance " + instance + " (we are " + instance_ + "): " + how +
                ". Both tell their own of the same topics. Give each a [gateway] name, or an [mqtt] base, "
                "of its own");
  }
  if (changes) {
    change_();
  }
}

void OtherGateway::tick(canopen::TimePoint now) {
  if (now < next()) {
    return;
  }
  notice_(Level::info, "MQTT: of the other gateway of our name, instance " + *who_ + ", nothing is heard any more");
  who_.reset();
  change_();
}

}  // namespace mqtt
