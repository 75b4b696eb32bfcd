#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace support {

/// A mosquitto of the test's own: on loopback and a free port, with a configuration and a directory of its own, ended
/// by its process id.
class Mosquitto {
 public:
  /// `extra`: further lines of its configuration.
  explicit Mosquitto(const std::string& extra = {});
  ~Mosquitto();
  Mosquitto(const Mosquitto&) = delete;
  Mosquitto& operator=(const Mosquitto&) = delete;

  /// False when it does not accept connections within a few seconds.
  [[nodiscard]] bool start();
  void stop();
  /// It and its connections stand still, as when it hangs; resume() goes on.
  void freeze() const;
  void resume() const;

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  [[nodiscard]] const std::filesystem::path& directory() const noexcept { return directory_; }

 private:
  std::filesystem::path directory_;
  std::uint16_t port_;
  pid_t process_ = 0;
};

/// A port nobody listens on just now.
[[nodiscard]] std::uint16_t free_port();

}  // namespace support
