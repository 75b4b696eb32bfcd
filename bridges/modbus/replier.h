#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "bridges/modbus/exception.h"
#include "bridges/modbus/request.h"
#include "bridges/modbus/snapshot.h"

struct _modbus;

namespace modbus {

enum class Sent : std::uint8_t {
  all,
  would_block,  ///< Nothing was sent: the same again once the socket is writable.
  failed        ///< The connection is of no use any more.
};

/// Words and sends answers with libmodbus, which keeps nothing between two of them but the socket. It is only ever
/// given requests that parse_request() found right: for others it sleeps, or reads beyond their end.
class Replier {
 public:
  /// Throws std::bad_alloc.
  Replier();

  [[nodiscard]] Sent refuse(int socket, std::span<const std::uint8_t> frame, Exception exception);
  /// `request` is that of `frame`; its reads are in `values`.
  [[nodiscard]] Sent answer(int socket, std::span<const std::uint8_t> frame, const Request& request, Snapshot& values);

 private:
  struct Free {
    void operator()(_modbus* context) const noexcept;
  };

  [[nodiscard]] Sent answer_read(std::span<const std::uint8_t> frame, const Request& request, Snapshot& values);
  [[nodiscard]] Sent answer_write(std::span<const std::uint8_t> frame, const Request& request);
  [[nodiscard]] Sent answer_read_write(std::span<const std::uint8_t> frame, const Snapshot& values);

  std::unique_ptr<_modbus, Free> context_;
};

}  // namespace modbus
