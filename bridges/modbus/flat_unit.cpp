#include "bridges/modbus/flat_unit.h"

#include <algorithm>
#include <span>
#include <utility>

#include "bridges/modbus/addresses.h"

namespace modbus {
namespace {

// What is left of `range` behind its first `quantity` addresses.
Range behind(Range range, std::size_t quantity) {
  return {.address = static_cast<std::uint16_t>(range.address + quantity),
          .quantity = static_cast<std::uint16_t>(range.quantity - quantity)};
}

}  // namespace

std::optional<FlatUnit::Part> FlatUnit::first_part(Range range) const {
  const auto block = std::ranges::find_if(blocks_, [&range](const Block& candidate) {
    return range.address >= candidate.base && range.address - candidate.base < kFlatBlock;
  });
  if (block == blocks_.end()) {
    return std::nullopt;
  }
  const auto offset = static_cast<std::uint16_t>(range.address - block->base);
  const bool diagnostics = offset >= kFlatSignals;
  const std::size_t end = diagnostics ? kFlatBlock : kFlatSignals;
  const std::size_t quantity = std::min<std::size_t>(range.quantity, end - offset);
  const auto address = static_cast<std::uint16_t>(diagnostics ? offset - kFlatSignals + kDiagnosticsBegin : offset);
  return Part{block->unit, {.address = address, .quantity = static_cast<std::uint16_t>(quantity)}};
}

std::optional<std::pair<DriveUnit*, Request>> FlatUnit::own(const Request& request) const {
  const std::optional<Part> part = first_part(request.write);
  if (!part || part->range.quantity != request.write.quantity) {
    return std::nullopt;
  }
  Request translated = request;
  translated.read = {};
  translated.write = part->range;
  return std::pair(part->unit, translated);
}

std::optional<Exception> FlatUnit::read(const Request& request, canopen::TimePoint now, Snapshot& into) const {
  std::optional<Exception> refused;
  Range rest = request.read;
  for (std::size_t done = 0; rest.quantity > 0;) {
    const std::optional<Part> part = first_part(rest);
    if (!part) {
      return Exception::illegal_address;
    }
    const std::size_t quantity = part->range.quantity;
    const std::optional<Exception> failed =
        request.of_bits()
            ? part->unit->read_bits(part->range, now, std::span(into.bits).subspan(done, quantity))
            : part->unit->read_registers(part->range, now, std::span(into.registers).subspan(done, quantity));
    if (failed == Exception::illegal_address) {
      return failed;  // That goes before a value that is not fresh, as on a drive's own unit.
    }
    refused = refused ? refused : failed;
    done += quantity;
    rest = behind(rest, quantity);
  }
  return refused;
}

void FlatUnit::sign_of_life(const Request& request, const process::Writer& writer) {
  for (Range rest : {request.read, request.write}) {
    while (rest.quantity > 0) {
      const std::optional<Part> part = first_part(rest);
      if (!part) {
        break;
      }
      part->unit->sign_of_life(writer);
      rest = behind(rest, part->range.quantity);
    }
  }
}

const DriveUnit* FlatUnit::written_by(const Request& request) const {
  const std::optional<Part> part = first_part(request.write);
  return part ? part->unit : nullptr;
}

bool FlatUnit::is_stop(const Request& request) const {
  const auto asked = own(request);
  return asked && asked->first->is_stop(asked->second);
}

Exception FlatUnit::note_refused(const Request& request, process::Origin origin, canopen::Error why) {
  const std::optional<Part> part = first_part(request.write);
  if (!part) {
    return Exception::illegal_address;
  }
  Request translated = request;
  translated.write = part->range;
  return part->unit->note_refused(translated, std::move(origin), std::move(why));
}

void FlatUnit::remark(const Request& request, const std::string& text) {
  if (const std::optional<Part> part = first_part(request.write)) {
    part->unit->drive().remark(text);
  }
}

boost::asio::awaitable<std::optional<Exception>> FlatUnit::write(Request request, process::Origin origin) {
  const auto asked = own(request);
  if (!asked) {
    co_return note_refused(request, std::move(origin),
                           {.kind = canopen::ErrorKind::read_only,
                            .detail = "what one request writes on the flat unit must be of one drive"});
  }
  const std::optional<Exception> refused = co_await asked->first->write(asked->second, std::move(origin));
  co_return refused;
}

}  // namespace modbus
