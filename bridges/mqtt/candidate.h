#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/attempts.h"
#include "bridges/mqtt/errand.h"
#include "config/model.h"

namespace mqtt {

/// One of the brokers, and what the publisher's thread knows of it.
struct Candidate {
  Candidate(config::Endpoint endpoint, int version)
      : broker(std::move(endpoint)),
        name(uri_host(broker.host) + ":" + std::to_string(broker.port)),
        attempts(version) {}

  config::Endpoint broker;
  std::string name;  ///< `HOST:PORT`.
  Attempts attempts;
  Errand<std::vector<std::string>> look_up;  ///< Of its name.
  std::vector<std::string> resolved{};       ///< Its addresses, numeric.
  std::string said{};                        ///< Why it gave no connection, as it stands in the log.
};

}  // namespace mqtt
