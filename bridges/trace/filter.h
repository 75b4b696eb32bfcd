#pragma once

#include <bitset>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/trace/entry.h"
#include "canopen/cob_id.h"
#include "canopen/error.h"
#include "config/model.h"

namespace trace {

/// Lists with commas, as people write them; empty: all.
struct FilterWords {
  std::string names{};    ///< Of drives and buses: `pump1,can0`.
  std::string kinds{};    ///< `sdo,emcy`
  std::string cob_ids{};  ///< `0x185,0x205`, hexadecimal with or without 0x.
};

/// Which frames somebody wants to see: of one of the drives or buses, and of one of the kinds, and with one of the
/// COB-IDs.
struct Filter {
  bool by_name = false;                                          ///< Else all drives and buses.
  std::vector<bool> drives{};                                    ///< By position; empty without `by_name`.
  std::vector<bool> buses{};                                     ///< Likewise.
  std::uint8_t kinds = 0xFF;                                     ///< A bit for each Kind.
  std::optional<std::bitset<canopen::kMaxCobId + 1>> cob_ids{};  ///< Nothing: all of them.
};

/// `unknown` names what there is not, and what there is.
[[nodiscard]] canopen::Result<Filter> make_filter(const config::Model& model, const FilterWords& words);

/// The same drives and buses, by their names, where the configuration is another one now.
[[nodiscard]] Filter moved(Filter filter, const config::Model& before, const config::Model& now);

/// NMT commands to all nodes are for the drives of their bus, too; lost frames may have been of any.
[[nodiscard]] bool passes(const config::Model& model, const Filter& filter, const Entry& entry);

}  // namespace trace
