#pragma once

#include <cstdint>
#include <string>

namespace canopen {

/// `value` in upper-case hexadecimal with at least `digits` digits, without prefix.
[[nodiscard]] std::string hex(std::uint64_t value, unsigned digits);

}  // namespace canopen
