#pragma once

#include <span>
#include <string_view>

namespace config {

/// The candidate that takes the fewest typing mistakes (insert, drop, replace, swap) to become `name`; the first of
/// equals. Empty where there is no candidate.
[[nodiscard]] std::string_view nearest(std::string_view name, std::span<const std::string_view> candidates);

}  // namespace config
