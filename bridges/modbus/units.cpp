#include "bridges/modbus/units.h"

#include <algorithm>
#include <utility>

#include "bridges/modbus/drive_objects.h"
#include "canopen/hex.h"

namespace modbus {

Units::Units(process::Plant& plant, const config::Modbus& settings)
    : plant_(plant), order_(settings.word_order), flat_unit_(settings.flat_unit), gateway_(plant, settings.word_order) {
  change({.drives = process::PlantChange::From(plant.size()), .buses = {}});
  std::ranges::fill(since_, canopen::TimePoint::min());
}

std::unique_ptr<DriveUnit> Units::make_unit(std::size_t drive) const {
  const config::Drive& model = plant_.drive(drive).model();
  return model.unit || model.flat ? std::make_unique<DriveUnit>(plant_, plant_.drive(drive), order_) : nullptr;
}

void Units::change(const process::PlantChange& change) {
  of_drive_ =
      process::realigned(std::move(of_drive_), change.drives, [this](std::size_t drive) { return make_unit(drive); });
  since_ = process::realigned(std::move(since_), change.drives, [](std::size_t) { return canopen::Clock::now(); });
  by_id_.fill(nullptr);
  flat_ = {};
  for (const std::unique_ptr<DriveUnit>& unit : of_drive_) {
    if (unit == nullptr) {
      continue;
    }
    const config::Drive& model = unit->drive().model();
    if (model.unit) {
      by_id_[*model.unit] = unit.get();
    }
    if (model.flat) {
      flat_.add(*model.flat, *unit);
    }
  }
}

bool Units::has(std::uint8_t unit) const noexcept {
  return is_gateway(unit) || is_flat(unit) || by_id_[unit] != nullptr;
}

std::optional<Exception> Units::read(std::uint8_t unit, const Request& request, canopen::TimePoint now,
                                     Snapshot& into) const {
  if (is_gateway(unit)) {
    return request.of_bits() ? gateway_.read_bits(request.read, into.bits)
                             : gateway_.read_registers(request.read, now, into.registers);
  }
  if (is_flat(unit)) {
    return flat_.read(request, now, into);
  }
  const DriveUnit& drive = *by_id_[unit];
  return request.of_bits() ? drive.read_bits(request.read, now, into.bits)
                           : drive.read_registers(request.read, now, into.registers);
}

void Units::sign_of_life(std::uint8_t unit, const Request& request, const process::Writer& writer) {
  if (is_flat(unit)) {
    flat_.sign_of_life(request, writer);
  } else if (!is_gateway(unit)) {
    by_id_[unit]->sign_of_life(writer);
  }
}

bool Units::is_stop(std::uint8_t unit, const Request& request) const {
  if (is_flat(unit)) {
    return flat_.is_stop(request);
  }
  return is_gateway(unit) ? GatewayUnit::is_stop(request) : by_id_[unit]->is_stop(request);
}

canopen::TimePoint Units::there_since(std::uint8_t unit, const Request& request) noexcept {
  const DriveUnit* const own = is_flat(unit) ? flat_.written_by(request) : by_id_[unit];
  const process::Drive* drive = own != nullptr ? &own->drive() : nullptr;
  if (request.is_encapsulated() && Encapsulated{request.encapsulated[1]} == Encapsulated::canopen) {
    const std::variant<Reference, Exception> parsed = parse_reference(request.encapsulated);
    const auto* const reference = std::get_if<Reference>(&parsed);
    drive = reference != nullptr ? drive_of(unit, reference->node) : nullptr;
  }
  return drive != nullptr ? since_[drive->index()] : canopen::TimePoint::min();
}

void Units::note_refused(std::uint8_t unit, const Request& request, process::Origin origin, canopen::Error why) {
  if (is_flat(unit)) {
    flat_.note_refused(request, std::move(origin), std::move(why));
  } else if (is_gateway(unit)) {
    gateway_.note_refused(request, origin, why);
  } else {
    by_id_[unit]->note_refused(request, std::move(origin), std::move(why));
  }
}

void Units::note_unread(std::uint8_t unit, const Request& request, const process::Writer& writer, Exception answered) {
  const char* const why =
      answered == Exception::no_response ? "is not fresh any more" : "cannot be read";  // a stop is not kept back by it
  const std::string text = "function 23 of " + to_string(writer) +
                           ": what it wrote is confirmed, but what it was to read " + why + "; answered 0x" +
                           canopen::hex(static_cast<std::uint8_t>(answered), 2);
  if (is_flat(unit)) {
    flat_.remark(request, text);
  } else if (!is_gateway(unit)) {
    by_id_[unit]->drive().remark(text);
  }
}

boost::asio::awaitable<std::optional<Exception>> Units::write(std::uint8_t unit, Request request,
                                                              process::Origin origin) {
  std::optional<Exception> refused;
  if (is_gateway(unit)) {
    refused = co_await gateway_.write(request, std::move(origin));
  } else if (is_flat(unit)) {
    refused = co_await flat_.write(request, std::move(origin));
  } else {
    refused = co_await by_id_[unit]->write(request, std::move(origin));
  }
  co_return refused;
}

process::Drive* Units::drive_of(std::uint8_t unit, std::uint8_t node) noexcept {
  if (const DriveUnit* const own = by_id_[unit]) {
    return own->drive().model().node.node == node ? &own->drive() : nullptr;
  }
  process::Drive* first = nullptr;
  for (std::size_t i = 0; i < plant_.size(); ++i) {
    process::Drive& drive = plant_.drive(i);
    if (drive.model().node.node == node && (first == nullptr || drive.bus() < first->bus())) {
      first = &drive;
    }
  }
  return first;
}

boost::asio::awaitable<EncapsulatedAnswer> Units::identify_unit(std::uint8_t unit, std::span<const std::uint8_t> pdu) {
  const DriveUnit* const own = by_id_[unit];
  if (own == nullptr) {
    co_return identify(pdu, identity_of_gateway(plant_.model()));
  }
  std::vector<IdentityObject> objects = identity_of_drive(plant_.model(), own->drive().model(), own->drive().bus());
  std::vector<IdentityObject> told = co_await told_identity(own->drive(), pdu);
  std::ranges::move(told, std::back_inserter(objects));
  co_return identify(pdu, objects);
}

boost::asio::awaitable<EncapsulatedAnswer> Units::encapsulated(std::uint8_t unit, Request request,
                                                               process::Origin origin, bool may_write) {
  const std::span<const std::uint8_t> pdu = request.encapsulated;
  if (Encapsulated{pdu[1]} == Encapsulated::device_identification) {
    EncapsulatedAnswer answer = co_await identify_unit(unit, pdu);
    co_return answer;
  }
  const std::variant<Reference, Exception> parsed = parse_reference(pdu);
  if (const auto* const refused = std::get_if<Exception>(&parsed)) {
    co_return *refused;
  }
  const auto& reference = std::get<Reference>(parsed);
  process::Drive* const drive = drive_of(unit, reference.node);
  if (reference.write && !may_write) {
    if (drive != nullptr) {
      (void)drive->refuse(std::move(origin), process::CommandRecord::Kind::raw,
                          {.kind = canopen::ErrorKind::forbidden,
                           .object = reference.object,
                           .detail = "[modbus] write_from does not name it"});
    }
    co_return Exception::illegal_function;
  }
  if (drive == nullptr) {
    co_return Exception::illegal_address;
  }
  EncapsulatedAnswer answer = co_await carry_out(*drive, pdu, reference, std::move(origin));
  co_return answer;
}

}  // namespace modbus
