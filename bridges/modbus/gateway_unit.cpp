#include "bridges/modbus/gateway_unit.h"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "bridges/modbus/words.h"
#include "bridges/process/stop_all.h"

namespace modbus {
namespace {

constexpr canopen::Duration kCounterStep = std::chrono::milliseconds(100);
constexpr std::size_t kNodeBitsBegin = 10;

bool writes_stop_register(const Request& request) {
  const bool written =
      request.function == Function::write_single_register || request.function == Function::write_multiple_registers;
  return written && request.write == Range{.address = kStopRegister, .quantity = 1};
}

bool is_zero(const Request& request) {
  return request.values[0] == 0 && request.values[1] == 0;
}

}  // namespace

GatewayUnit::GatewayUnit(process::Plant& plant, config::WordOrder order)
    : plant_(plant), order_(order), started_(canopen::Clock::now()) {}

std::optional<Exception> GatewayUnit::read_registers(Range range, canopen::TimePoint now,
                                                     std::span<std::uint16_t> out) const {
  const std::size_t buses = plant_.model().buses.size();
  const std::size_t bus_end = std::min<std::size_t>(kBusBlockBegin + buses * kBusBlockSize, kDiagnosticsBegin);
  std::optional<std::size_t> filled;
  BusBlock block{};
  for (std::size_t i = 0; i < range.quantity; ++i) {
    const auto address = static_cast<std::uint16_t>(range.address + i);
    if (address >= kBusBlockBegin && address < bus_end) {
      const std::size_t offset = address - kBusBlockBegin;
      if (filled != offset / kBusBlockSize) {
        filled = offset / kBusBlockSize;
        block = bus_block(*filled);
      }
      out[i] = block[offset % kBusBlockSize];
    } else if (address < kCommonAddresses || is_diagnostic(address)) {
      out[i] = general(address, now);
    } else {
      return Exception::illegal_address;
    }
  }
  return std::nullopt;
}

std::optional<Exception> GatewayUnit::read_bits(Range range, std::span<std::uint8_t> out) const {
  if (range.address + range.quantity > kCommonAddresses) {
    return Exception::illegal_address;
  }
  std::ranges::fill(out.first(range.quantity), std::uint8_t{0});
  return std::nullopt;
}

boost::asio::awaitable<std::optional<Exception>> GatewayUnit::write(Request request, process::Origin origin) {
  if (!writes_stop_register(request)) {
    co_return Exception::illegal_address;
  }
  if (is_zero(request)) {
    co_return Exception::illegal_value;
  }
  const bool commands_none = process::commanded_by(plant_, origin.writer) == 0;
  const std::vector<process::NotStopped> missed = co_await process::stop_all(plant_, std::move(origin));
  if (commands_none) {
    co_return Exception::illegal_function;
  }
  co_return missed.empty() ? std::nullopt : std::optional(Exception::no_response);
}

bool GatewayUnit::is_stop(const Request& request) {
  return writes_stop_register(request) && !is_zero(request);
}

void GatewayUnit::note_refused(const Request& request, const process::Origin& origin, const canopen::Error& why) {
  if (is_stop(request)) {
    process::refuse_stop_all(plant_, origin, why);
  }
}

std::uint16_t GatewayUnit::general(std::uint16_t address, canopen::TimePoint now) const {
  switch (address) {
    case 0:
      return static_cast<std::uint16_t>((now - started_) / kCounterStep);
    case 1:
      return static_cast<std::uint16_t>(plant_.size());
    case 2:
      return static_cast<std::uint16_t>(plant_.online());
    case 3:
      return static_cast<std::uint16_t>(plant_.with_alarm());
    case 4:
      return mqtt_connected_ ? 1 : 0;
    case 5:
      return static_cast<std::uint16_t>(clients_);
    case 6:
      return static_cast<std::uint16_t>(refused_);
    case 7:
      return lost_messages_ ? static_cast<std::uint16_t>(lost_messages_()) : std::uint16_t{0};
    default:
      return 0;
  }
}

GatewayUnit::BusBlock GatewayUnit::bus_block(std::size_t bus) const {
  const canopen::BusState& state = plant_.bus_state(bus);
  const canopen::BusStatistics statistics = plant_.bus_statistics(bus);
  BusBlock block{};
  block[0] = static_cast<std::uint16_t>(state.condition);
  block[1] = statistics.load_per_mille;
  block[2] = state.transmit_errors;
  block[3] = state.receive_errors;
  block[4] = static_cast<std::uint16_t>(statistics.bus_offs);
  block[5] = static_cast<std::uint16_t>(statistics.frames_lost);
  put_words(static_cast<std::uint32_t>(statistics.frames_received), order_, std::span(block).subspan<6, 2>());
  put_words(static_cast<std::uint32_t>(statistics.frames_sent), order_, std::span(block).subspan<8, 2>());
  block[18] = statistics.highest_load_per_mille;
  block[19] = statistics.error_frames;
  for (std::size_t i = 0; i < plant_.size(); ++i) {
    const process::Drive& drive = plant_.drive(i);
    const canopen::NodeStatus& status = drive.status();
    if (drive.bus() == bus && status.online && status.nmt_now() == canopen::NmtState::operational) {
      const std::size_t node = drive.model().node.node;
      std::uint16_t& word = block[kNodeBitsBegin + node / 16];
      word = static_cast<std::uint16_t>(word | 1U << (node % 16));
    }
  }
  return block;
}

}  // namespace modbus
