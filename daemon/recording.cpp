#include "daemon/recording.h"

#include <spdlog/spdlog.h>

#include <string>
#include <utility>

namespace gateway {

Recording::Recording(const boost::asio::any_io_executor& executor, process::Plant& plant,
                     std::vector<canopen::Bus*> buses)
    : buses_(std::move(buses)),
      recorder_(executor, plant,
                {.state_directory = plant.model().gateway.state_dir,
                 .keep = plant.model().recorder.value_or(config::Recorder{}).keep},
                [this](std::size_t bus, canopen::TimePoint until) { return buses_[bus]->may_still_hear(until); },
                {.warning = [](const std::string& text) { spdlog::warn("recorder: {}", text); },
                 .info = [](const std::string& text) { spdlog::info("recorder: {}", text); }}),
      reader_(executor, recorder_.keeper().directory()) {
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    taps_.push_back(buses_[i]->add_tap(recorder_.ring(i)));
  }
}

}  // namespace gateway
