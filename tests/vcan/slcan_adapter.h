#pragma once

#include <mutex>
#include <string>
#include <thread>

namespace support {

/// The device end of a serial CAN adapter (slcan): a test says what the adapter says, and reads what it was told. The
/// interface is there from construction and goes with the object, as a pulled USB adapter does. A thread reads for it,
/// since the driver waits for its commands to be taken. Needs root and the module slcan.
class SlcanAdapter {
 public:
  /// Throws std::system_error.
  SlcanAdapter();
  ~SlcanAdapter();
  SlcanAdapter(const SlcanAdapter&) = delete;
  SlcanAdapter& operator=(const SlcanAdapter&) = delete;

  [[nodiscard]] const std::string& interface() const noexcept { return interface_; }
  /// A line without its end, such as `t185281AA` (a frame) or `sb255255` (bus-off).
  void say(const std::string& line);
  /// All that was told so far.
  [[nodiscard]] std::string heard();

 private:
  void listen(const std::stop_token& stop);

  int device_ = -1;
  int terminal_ = -1;
  std::string interface_;
  std::mutex mutex_;
  std::string heard_;
  std::jthread listener_;
};

}  // namespace support
