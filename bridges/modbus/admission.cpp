#include "bridges/modbus/admission.h"

#include <algorithm>
#include <chrono>

namespace modbus {
namespace {

// A SCADA asks every few seconds; one of `write_from` that was silent this long may have forgotten its connection.
constexpr canopen::Duration kForgotten = std::chrono::seconds(60);

// The one that was silent longest, and at least since `latest`, of those that `may_leave`.
template <class MayLeave>
std::optional<std::size_t> most_silent(std::span<const Caller> clients, canopen::TimePoint latest, MayLeave may_leave) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < clients.size(); ++i) {
    const auto since = clients[i].silent_since;
    if (may_leave(clients[i]) && since && *since <= latest && (!found || *since < *clients[*found].silent_since)) {
      found = i;
    }
  }
  return found;
}

}  // namespace

Admission admit(const Caller& caller, std::span<const Caller> clients, std::size_t max_clients,
                canopen::TimePoint now) {
  const auto same = static_cast<std::size_t>(std::ranges::count(clients, caller.address, &Caller::address));
  if (max_clients > 1 && same >= (max_clients + 1) / 2) {
    // What it forgot itself keeps nobody out, itself neither.
    const auto own = most_silent(clients, now - kForgotten,
                                 [&caller](const Caller& client) { return client.address == caller.address; });
    return own ? Admission{.instead_of = own}
               : Admission{.refusal = "refused: this address has half of max_clients already"};
  }
  if (clients.size() < max_clients) {
    return {};
  }
  if (!caller.may_write) {
    return {.refusal = "refused: max_clients are connected"};
  }
  std::optional<std::size_t> leaves = most_silent(clients, now, [](const Caller& client) { return !client.may_write; });
  if (!leaves) {
    leaves = most_silent(clients, now - kForgotten, [](const Caller& client) { return client.may_write; });
  }
  if (!leaves) {
    return {.refusal = "refused: max_clients are connected, and all of them are at work"};
  }
  return {.instead_of = leaves};
}

}  // namespace modbus
