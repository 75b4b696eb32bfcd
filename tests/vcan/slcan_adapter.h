#pragma once

#include <mutex>
#include <string>
#include <thread>

namespace support {

/// A pseudo terminal with the line discipline of slcan on one side: the interface is there from construction and goes
/// with the object, as a pulled USB adapter does. Whoever reads and writes the other side is the adapter. Needs root
/// and the module slcan.
class SlcanTerminal {
 public:
  /// Throws std::system_error.
  SlcanTerminal();
  ~SlcanTerminal();
  SlcanTerminal(const SlcanTerminal&) = delete;
  SlcanTerminal& operator=(const SlcanTerminal&) = delete;

  [[nodiscard]] const std::string& interface() const noexcept { return interface_; }
  [[nodiscard]] int device() const noexcept { return device_; }
  /// A line without its end, such as `t185281AA` (a frame) or `sb255255` (bus-off).
  void say(const std::string& line) const;

 private:
  int device_ = -1;
  int terminal_ = -1;
  std::string interface_;
};

/// The device end of a serial CAN adapter: a test says what the adapter says, and reads what it was told. A thread
/// reads for it, since the driver waits for its commands to be taken.
class SlcanAdapter {
 public:
  /// Throws std::system_error.
  SlcanAdapter();
  ~SlcanAdapter();
  SlcanAdapter(const SlcanAdapter&) = delete;
  SlcanAdapter& operator=(const SlcanAdapter&) = delete;

  [[nodiscard]] const std::string& interface() const noexcept { return terminal_.interface(); }
  void say(const std::string& line) { terminal_.say(line); }
  /// All that was told so far.
  [[nodiscard]] std::string heard();

 private:
  void listen(const std::stop_token& stop);

  SlcanTerminal terminal_;
  std::mutex mutex_;
  std::string heard_;
  std::jthread listener_;
};

}  // namespace support
