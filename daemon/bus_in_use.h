#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <memory>
#include <string>

#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/bus_watch.h"
#include "canopen/bus/link.h"
#include "canopen/bus/subscription.h"
#include "config/model.h"
#include "daemon/surveys.h"

namespace canopen {
class BusSurvey;
}

namespace gateway {

/// A bus of the plant, and who looks after it.
class BusInUse {
 public:
  BusInUse(const boost::asio::any_io_executor& executor, const config::Bus& settings,
           std::unique_ptr<canopen::Link> link);
  ~BusInUse();
  BusInUse(const BusInUse&) = delete;
  BusInUse& operator=(const BusInUse&) = delete;

  /// Its state, timing, and who else is on it reach plant and log. `position` in config::Model::buses. The plant
  /// outlives it, or its stop().
  void follow(process::Plant& plant, std::size_t position);
  /// After the plant changed: it has this position now, and other drives perhaps.
  void move(const process::Plant& plant, std::size_t position);
  void start();
  /// Nothing of it is told any more.
  boost::asio::awaitable<void> stop();

  [[nodiscard]] canopen::Bus& bus() noexcept { return bus_; }
  [[nodiscard]] const canopen::BusSurvey& survey() const { return *survey_; }
  [[nodiscard]] process::Plant::BusPort port();

 private:
  void watch_commands(const process::Plant& plant);

  boost::asio::any_io_executor executor_;
  std::string name_;
  canopen::Bus bus_;
  SurveyedBus known_;
  std::unique_ptr<canopen::BusWatch> watch_;
  std::unique_ptr<canopen::BusSurvey> survey_;
  canopen::Subscription state_;
  canopen::Subscription timing_;
};

}  // namespace gateway
