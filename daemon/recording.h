#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <vector>

#include "bridges/process/plant.h"
#include "bridges/recorder/record_reader.h"
#include "bridges/recorder/recorder.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/subscription.h"

namespace gateway {

/// The recorder, at the buses of the plant, and who reads its files.
class Recording {
 public:
  /// Both outlive it. The plant has a [recorder] and a state directory, the buses its order.
  Recording(const boost::asio::any_io_executor& executor, process::Plant& plant, std::vector<canopen::Bus*> buses);

  [[nodiscard]] recorder::Recorder& recorder() noexcept { return recorder_; }
  [[nodiscard]] recorder::RecordReader& reader() noexcept { return reader_; }

 private:
  std::vector<canopen::Bus*> buses_;
  recorder::Recorder recorder_;
  recorder::RecordReader reader_;
  std::vector<canopen::Subscription> taps_;  ///< They show frames to the recorder.
};

}  // namespace gateway
