#include "canopen/bus/transmission.h"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <utility>

namespace canopen {

Transmission::Transmission(Bus& bus, TransmitClass transmit_class, const Frame& frame, TimePoint deadline,
                           std::function<void()> on_left)
    : bus_(bus), timer_(bus.executor_, kNever) {
  ++bus_.transmissions_;
  ticket_ = bus_.send(transmit_class, frame, deadline, [this, on_left = std::move(on_left)](Departure departure) {
    departure_ = departure;
    if (departure == Departure::left && on_left) {
      on_left();
    }
    timer_.cancel();
  });
}

Transmission::~Transmission() {
  --bus_.transmissions_;
}

boost::asio::awaitable<Result<void>> Transmission::result() {
  if (!departure_) {
    boost::system::error_code cancelled;
    co_await timer_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, cancelled));
  }
  co_return result_of(departure_.value_or(Departure::offline));
}

Result<void> result_of(Departure departure) {
  switch (departure) {
    case Departure::left:
      return {};
    case Departure::withdrawn:
      return Error{.kind = ErrorKind::timeout, .not_sent = true, .detail = "not sent before its deadline; withdrawn"};
    case Departure::unknown:
      return Error{.kind = ErrorKind::timeout, .outcome_unknown = true, .detail = "its departure was not seen"};
    case Departure::offline:
      break;
  }
  return Error{.kind = ErrorKind::offline,
               .not_sent = true,
               .detail = "the bus is down, or takes no command until a frame of ours has left"};
}

}  // namespace canopen
