#pragma once

#include <span>
#include <string>
#include <string_view>

namespace config {

/// The candidate that takes the fewest typing mistakes (insert, drop, replace, swap) to become `name`; the first of
/// equals. Empty where none is near: where more than half of the longer name would have to change, and neither begins
/// with the other.
[[nodiscard]] std::string_view nearest(std::string_view name, std::span<const std::string_view> candidates);

/// `nearest is "x"`; where none is, `there are a, b`, or `there are none`.
[[nodiscard]] std::string nearest_or_all(std::string_view name, std::span<const std::string_view> candidates);

}  // namespace config
