#include "daemon/recording.h"

#include <spdlog/spdlog.h>

#include <string>
#include <utility>

namespace gateway {

Recording::Recording(const boost::asio::any_io_executor& executor, process::Plant& plant,
                     const std::vector<process::Plant::BusPort>& buses)
    : recorder_(executor, plant,
                {.state_directory = plant.model().gateway.state_dir,
                 .keep = plant.model().recorder.value_or(config::Recorder{}).keep},
                [this](std::size_t bus, canopen::TimePoint until) { return buses_[bus]->may_still_hear(until); },
                {.warning = [](const std::string& text) { spdlog::warn("recorder: {}", text); },
                 .info = [](const std::string& text) { spdlog::info("recorder: {}", text); }}),
      reader_(executor, recorder_.keeper().directory()) {
  for (const process::Plant::BusPort& port : buses) {
    taps_.push_back(port.bus->add_tap(recorder_.ring(buses_.size())));
    buses_.push_back(port.bus);
  }
}

void Recording::show_in(http::Site& site) {
  site.records = [this]() -> const std::optional<recorder::StoredRecords>& { return recorder_.keeper().records(); };
  site.recorder = [this] {
    return http::RecorderFigures{.works = recorder_.keeper().works(), .lost = recorder_.keeper().lost()};
  };
  site.read_record = [this](std::string name, std::uint64_t offset) { return read(std::move(name), offset); };
}

// What cannot be read was removed by somebody, most likely: alarms and lists are to name it no more.
boost::asio::awaitable<std::optional<std::string>> Recording::read(std::string name, std::uint64_t offset) {
  std::optional<std::string> piece = co_await reader_.read(std::move(name), offset);
  if (!piece && !reader_.is_stopped()) {
    recorder_.look_again();
  }
  co_return piece;
}

std::unique_ptr<Recording> make_recording(const boost::asio::any_io_executor& executor, process::Plant& plant,
                                          const std::vector<process::Plant::BusPort>& buses) {
  if (!plant.model().recorder) {
    return nullptr;
  }
  auto recording = std::make_unique<Recording>(executor, plant, buses);
  plant.add(recording->recorder());
  return recording;
}

control::RecordRequest record_request(Recording* recording) {
  if (recording == nullptr) {
    return {};
  }
  return [recording](std::size_t bus, const std::string& drive, const std::string& user) {
    return recording->recorder().request(bus, drive, user);
  };
}

}  // namespace gateway
