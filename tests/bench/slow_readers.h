#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace bench {

/// A socket that has sent `request` to a HTTP server of this machine and takes little at a time. It comes from
/// 127.0.0.N with N = 2..6 in turn by `number`, for no address gets all of the room. Throws std::runtime_error.
[[nodiscard]] int slow_http_reader(std::uint16_t port, std::string_view request, int number);
/// The same to a control socket.
[[nodiscard]] int slow_control_reader(const std::string& path, std::string_view request);

/// Clients that asked for a stream and take little of it: 128 bytes each, ten times a second.
class SlowReaders {
 public:
  /// The sockets are closed by this.
  explicit SlowReaders(std::vector<int> descriptors);
  ~SlowReaders();
  SlowReaders(const SlowReaders&) = delete;
  SlowReaders& operator=(const SlowReaders&) = delete;

  /// Of those that the server has neither refused nor disconnected.
  [[nodiscard]] int streaming() const noexcept { return streaming_; }

 private:
  void take();

  std::vector<int> descriptors_;
  std::atomic<int> streaming_ = 0;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace bench
