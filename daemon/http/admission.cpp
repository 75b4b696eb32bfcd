#include "daemon/http/admission.h"

#include <algorithm>

namespace gateway::http {
namespace {

template <class MayLeave>
std::optional<std::size_t> longest_idle(std::span<const Guest> guests, MayLeave may_leave) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < guests.size(); ++i) {
    const auto since = guests[i].idle_since;
    if (since && may_leave(guests[i]) && (!found || *since < *guests[*found].idle_since)) {
      found = i;
    }
  }
  return found;
}

}  // namespace

Admission admit(const boost::asio::ip::address& address, std::span<const Guest> guests, std::size_t most) {
  const auto same = static_cast<std::size_t>(std::ranges::count(guests, address, &Guest::address));
  if (most > 1 && same >= (most + 1) / 2) {
    const auto own = longest_idle(guests, [&address](const Guest& guest) { return guest.address == address; });
    return own ? Admission{.instead_of = own}
               : Admission{.refusal = "refused: this address has half of all connections, and each is being answered"};
  }
  if (guests.size() < most) {
    return {};
  }
  const auto idle = longest_idle(guests, [](const Guest&) { return true; });
  return idle ? Admission{.instead_of = idle}
              : Admission{.refusal = "refused: there is no room for further connections, and each is being answered"};
}

}  // namespace gateway::http
