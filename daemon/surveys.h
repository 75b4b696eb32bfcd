#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstddef>
#include <functional>
#include <memory>

#include "canopen/bus/bus_state.h"

namespace canopen {
class Bus;
class BusSurvey;
}  // namespace canopen

namespace process {
class Plant;
}

namespace gateway {

/// What the survey of a bus is told of it.
struct SurveyedBus {
  std::size_t index = 0;  ///< Position in config::Model::buses, as it is now.
  canopen::BusTroubles troubles{};
};

/// The survey of a bus, by its position in config::Model::buses. Empty: there are none.
using Surveys = std::function<const canopen::BusSurvey&(std::size_t bus)>;

/// Looks at `bus` with what the plant knows of its drives; tells the log of suspicions. All of it outlives the survey.
[[nodiscard]] std::unique_ptr<canopen::BusSurvey> make_survey(const boost::asio::any_io_executor& executor,
                                                              canopen::Bus& bus, const process::Plant& plant,
                                                              const SurveyedBus& known);
/// Which silence means that a drive of this bus is lost.
void set_timeouts(canopen::BusSurvey& survey, const process::Plant& plant, std::size_t bus);

}  // namespace gateway
