#pragma once

#include "config/document.h"

namespace config {

/// Lays `upper` over `lower`: tables key by key, `setup` lists one after the other, everything else (enumerations in
/// `values`, mappings, numbers) replaced as a whole. Values keep the place they came from.
void lay_over(Node& lower, const Node& upper);

}  // namespace config
