#include "bridges/modbus/words.h"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>

namespace modbus {
namespace {

constexpr unsigned kWordBits = 16;

std::uint64_t join_words(std::span<const std::uint8_t> bytes, config::WordOrder order) noexcept {
  const std::size_t count = bytes.size() / 2;
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = order == config::WordOrder::big ? i : count - 1 - i;
    const auto word = static_cast<std::uint16_t>(bytes[2 * from] << 8 | bytes[2 * from + 1]);
    value = value << kWordBits | word;
  }
  return value;
}

std::uint64_t extend(std::uint64_t value, std::size_t words) noexcept {
  const std::size_t bits = words * kWordBits;
  if (bits >= 64) {
    return value;
  }
  const std::uint64_t sign = std::uint64_t{1} << (bits - 1);
  return (value ^ sign) - sign;
}

// The decimal number that a person means by this float: 49.97, not 49.970001220703125. Else a limit of 49.97 would
// refuse the very float that is nearest to it.
double shortest(float number) noexcept {
  if (!std::isfinite(number)) {
    return static_cast<double>(number);
  }
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), number);
  double exact = static_cast<double>(number);
  std::from_chars(text.data(), written.ptr, exact);
  return exact;
}

}  // namespace

void put_words(std::uint64_t value, config::WordOrder order, std::span<std::uint16_t> out) noexcept {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t at = order == config::WordOrder::big ? out.size() - 1 - i : i;
    out[at] = static_cast<std::uint16_t>(value >> (kWordBits * i));
  }
}

void put_value(const config::Signal& signal, canopen::Raw raw, config::WordOrder order,
               std::span<std::uint16_t> out) noexcept {
  if (signal.modbus.as_float) {
    const auto number = static_cast<float>(canopen::to_number(signal.type, raw) * signal.scale);
    put_words(std::bit_cast<std::uint32_t>(number), order, out);
    return;
  }
  put_words(canopen::normalise(signal.type, raw), order, out);
}

process::GivenValue value_of(const config::Signal& signal, std::span<const std::uint8_t> bytes,
                             config::WordOrder order) noexcept {
  const std::uint64_t joined = join_words(bytes, order);
  if (signal.modbus.as_float) {
    return shortest(std::bit_cast<float>(static_cast<std::uint32_t>(joined)));
  }
  return canopen::is_signed(signal.type) ? extend(joined, bytes.size() / 2) : joined;
}

}  // namespace modbus
