#pragma once

#include "bridges/journal/line_queue.h"
#include "config/model.h"

namespace gateway {

/// Where the journal of a gateway is.
inline journal::Place journal_place(const config::Gateway& gateway) {
  journal::Place place;
  place.directory = std::filesystem::path(gateway.state_dir) / "journal";
  place.limit = gateway.journal;
  return place;
}

}  // namespace gateway
