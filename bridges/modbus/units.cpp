#include "bridges/modbus/units.h"

#include <utility>

#include "bridges/modbus/identification.h"

namespace modbus {

Units::Units(process::Plant& plant, config::WordOrder order)
    : plant_(plant), gateway_(plant, order), of_drive_(plant.size()) {
  for (std::size_t i = 0; i < plant.size(); ++i) {
    if (const auto unit = plant.drive(i).model().unit) {
      of_drive_[i] = std::make_unique<DriveUnit>(plant, i, order);
      by_id_[*unit] = of_drive_[i].get();
    }
  }
}

bool Units::has(std::uint8_t unit) const noexcept {
  return is_gateway(unit) || by_id_[unit] != nullptr;
}

std::optional<Exception> Units::read(std::uint8_t unit, const Request& request, canopen::TimePoint now,
                                     Snapshot& into) const {
  if (is_gateway(unit)) {
    return request.of_bits() ? gateway_.read_bits(request.read, into.bits)
                             : gateway_.read_registers(request.read, now, into.registers);
  }
  const DriveUnit& drive = *by_id_[unit];
  return request.of_bits() ? drive.read_bits(request.read, now, into.bits)
                           : drive.read_registers(request.read, now, into.registers);
}

void Units::sign_of_life(std::uint8_t unit, const Request& /*request*/, const process::Writer& writer) {
  if (!is_gateway(unit)) {
    by_id_[unit]->sign_of_life(writer);
  }
}

bool Units::is_stop(std::uint8_t unit, const Request& request) const {
  return !is_gateway(unit) && by_id_[unit]->is_stop(request);
}

void Units::note_refused(std::uint8_t unit, const Request& request, process::Origin origin, canopen::Error why) {
  if (!is_gateway(unit)) {
    by_id_[unit]->note_refused(request, std::move(origin), std::move(why));
  }
}

boost::asio::awaitable<std::optional<Exception>> Units::write(std::uint8_t unit, Request request,
                                                              process::Origin origin) {
  if (is_gateway(unit)) {
    const std::optional<Exception> refused = co_await gateway_.write(request, std::move(origin));
    co_return refused;
  }
  const std::optional<Exception> refused = co_await by_id_[unit]->write(request, std::move(origin));
  co_return refused;
}

boost::asio::awaitable<EncapsulatedAnswer> Units::encapsulated(std::uint8_t unit, Request request,
                                                               process::Origin /*origin*/, bool /*may_write*/) {
  if (Encapsulated{request.encapsulated[1]} != Encapsulated::device_identification) {
    co_return Exception::illegal_function;
  }
  const config::Model& model = plant_.model();
  co_return identify(request.encapsulated,
                     is_gateway(unit) ? identity_of_gateway(model) : identity_of_drive(model, by_id_[unit]->model()));
}

}  // namespace modbus
