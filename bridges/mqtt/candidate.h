#pragma once

#include <string>
#include <utility>

#include "bridges/mqtt/attempts.h"
#include "bridges/mqtt/broker_addresses.h"
#include "config/model.h"

namespace mqtt {

/// One of the brokers, and what the publisher's thread knows of it.
struct Candidate {
  Candidate(config::Endpoint endpoint, int version, Resolver resolver)
      : broker(std::move(endpoint)),
        name(uri_host(broker.host) + ":" + std::to_string(broker.port)),
        attempts(version),
        addresses(broker, std::move(resolver)) {}

  config::Endpoint broker;
  std::string name;  ///< `HOST:PORT`.
  Attempts attempts;
  BrokerAddresses addresses;
  std::string said{};       ///< Why it gave no connection, as it stands in the log.
  int wordless_breaks = 0;  ///< In a row, soon after the connection came about.
};

}  // namespace mqtt
