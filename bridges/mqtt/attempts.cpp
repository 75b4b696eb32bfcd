#include "bridges/mqtt/attempts.h"

#include <netdb.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "bridges/mqtt/reasons.h"

namespace mqtt {
namespace {

constexpr int kMqtt5 = 5;
constexpr int kMqtt311 = 4;
// So many closes instead of a CONNACK mean that the broker does not know MQTT 5.
constexpr int kCloses = 2;

}  // namespace

std::vector<std::string> resolve(const config::Endpoint& endpoint) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(endpoint.host.c_str(), nullptr, &hints, &found) != 0) {
    return {};
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> list(found, &freeaddrinfo);
  std::vector<std::string> addresses;
  for (const addrinfo* entry = list.get(); entry != nullptr; entry = entry->ai_next) {
    std::array<char, NI_MAXHOST> numeric{};
    const int failed =
        getnameinfo(entry->ai_addr, entry->ai_addrlen, numeric.data(), numeric.size(), nullptr, 0, NI_NUMERICHOST);
    const std::string address(numeric.data());
    if (failed == 0 && std::find(addresses.begin(), addresses.end(), address) == addresses.end()) {
      addresses.push_back(address);
    }
  }
  return addresses;
}

std::string uri_host(const std::string& host) {
  return host.find(':') == std::string::npos ? host : "[" + host + "]";
}

void Attempts::found(std::vector<std::string> addresses) {
  addresses_ = std::move(addresses);
  next_ = 0;
  std::erase_if(closes_, [this](const auto& each) {
    return std::find(addresses_.begin(), addresses_.end(), each.first) == addresses_.end();
  });
}

std::string Attempts::next_address() {
  return wants_addresses() ? std::string() : addresses_[next_++];
}

int Attempts::first_version() const noexcept {
  return fixed_version_ != 0 ? fixed_version_ : kMqtt5;
}

bool Attempts::is_undecided(const std::string& address) const {
  const auto closes = closes_.find(address);
  return fixed_version_ == 0 && closes != closes_.end() && closes->second < kCloses;
}

std::optional<int> Attempts::next_version(const std::string& address, int version,
                                          const std::optional<Refusal>& refusal) {
  const bool closed = refusal && refusal->closed;
  if (version != kMqtt5) {
    if (closed) {
      closes_.erase(address);  // it closes whatever the version
    }
    return std::nullopt;
  }
  const int closes = closed ? ++closes_[address] : 0;
  if (!closed) {
    closes_.erase(address);
  }
  const bool older = closes >= kCloses || (refusal && refuses_version(refusal->code));
  return older && fixed_version_ == 0 ? std::optional(kMqtt311) : std::nullopt;
}

}  // namespace mqtt
