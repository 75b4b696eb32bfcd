#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridges/process/plant.h"
#include "bridges/process/plant_change.h"
#include "bridges/recorder/record_reader.h"
#include "bridges/recorder/recorder.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/subscription.h"

namespace gateway {

/// The recorder, at the buses of the plant, and who reads its files.
class Recording {
 public:
  /// Both outlive it. The plant has a [recorder] and a state directory, the buses its order.
  Recording(const boost::asio::any_io_executor& executor, process::Plant& plant,
            const std::vector<process::Plant::BusPort>& buses);

  [[nodiscard]] recorder::Recorder& recorder() noexcept { return recorder_; }
  /// A piece of a record's file, for HTTP.
  [[nodiscard]] boost::asio::awaitable<std::optional<std::string>> read(std::string name, std::uint64_t offset);
  /// After the plant changed: `buses` in the order of now, of which those without a position in `from` are new.
  void follow(const std::vector<process::Plant::BusPort>& buses, const process::PlantChange::From& from);
  /// Nobody who reads a file keeps the end of the gateway waiting. Before HTTP is stopped.
  void stop_reading() { reader_.stop(); }
  /// When both were stopped: no thread of them is with the disk any more, for which the destructor would wait.
  [[nodiscard]] bool ended() const noexcept { return !reader_.is_busy() && !recorder_.keeper().is_busy(); }

 private:
  std::vector<canopen::Bus*> buses_;
  recorder::Recorder recorder_;
  recorder::RecordReader reader_;
  std::vector<canopen::Subscription> taps_;  ///< They show frames to the recorder.
};

/// Which adds itself to the plant's observers; nothing where the plant has no [recorder].
[[nodiscard]] std::unique_ptr<Recording> make_recording(const boost::asio::any_io_executor& executor,
                                                        process::Plant& plant,
                                                        const std::vector<process::Plant::BusPort>& buses);

}  // namespace gateway
