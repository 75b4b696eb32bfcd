#include "bridges/mqtt/broker_addresses.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace mqtt {

BrokerAddresses::BrokerAddresses(config::Endpoint broker, Resolver resolver)
    : broker_(std::move(broker)), resolver_(std::move(resolver)) {}

void BrokerAddresses::ask_ahead(TimePoint now) {
  if (!is_answered() || now < ahead_at_) {
    return;
  }
  ahead_at_ = now + kAhead;
  const bool is_address = known_ == std::vector<std::string>{broker_.host};
  if (!broker_.tls && !is_address) {
    begin();
  }
}

void BrokerAddresses::ask() {
  are_new_ = false;
  look_up_.forget_older(kAge);
  if (!look_up_.runs()) {
    begin();
  }
}

void BrokerAddresses::begin() {
  (void)look_up_.start([resolver = resolver_, broker = broker_] { return resolver(broker); });
}

bool BrokerAddresses::is_answered(std::chrono::milliseconds patience) {
  if (std::optional<std::vector<std::string>> found = look_up_.take(patience)) {
    are_new_ = !found->empty();
    if (are_new_) {
      known_ = *std::move(found);
    }
  }
  return !look_up_.runs();
}

std::vector<std::string> BrokerAddresses::to_try() const {
  if (!broker_.tls) {
    return known_;
  }
  return are_new_ ? std::vector<std::string>{broker_.host} : std::vector<std::string>();
}

bool BrokerAddresses::are_of_several() const {
  const auto of_v6 =
      std::ranges::count_if(known_, [](const auto& each) { return each.find(':') != std::string::npos; });
  return of_v6 > 1 || static_cast<std::ptrdiff_t>(known_.size()) - of_v6 > 1;
}

}  // namespace mqtt
