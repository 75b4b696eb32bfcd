#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

namespace bench {

/// A mosquitto of our own on loopback.
class Broker {
 public:
  explicit Broker(std::uint16_t port);
  ~Broker();
  Broker(const Broker&) = delete;
  Broker& operator=(const Broker&) = delete;

  [[nodiscard]] std::string uri() const;

 private:
  std::uint16_t port_;
  std::string config_;
  pid_t process_;
};

}  // namespace bench
