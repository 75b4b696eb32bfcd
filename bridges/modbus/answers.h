#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "bridges/modbus/exception.h"
#include "bridges/modbus/mbap.h"
#include "bridges/modbus/request.h"
#include "bridges/modbus/snapshot.h"

struct _modbus;

namespace modbus {

/// Where an answer is worded: header and PDU.
using AnswerRoom = std::span<std::uint8_t, kMaxFrame>;

/// Words answers with libmodbus. It can only send them, so it sends them to this process itself; what became of an
/// answer on its way to a client is no business of libmodbus. It is only ever given requests that parse_request() found
/// right: for others it sleeps, or reads beyond their end. All return the part of `out` that they fill; nothing where
/// libmodbus failed.
class Answers {
 public:
  /// Throws std::bad_alloc, std::system_error.
  Answers();
  ~Answers();
  Answers(const Answers&) = delete;
  Answers& operator=(const Answers&) = delete;

  [[nodiscard]] std::span<const std::uint8_t> refuse(std::span<const std::uint8_t> frame, Exception exception,
                                                     AnswerRoom out);
  /// `request` is that of `frame`; its reads are in `values`.
  [[nodiscard]] std::span<const std::uint8_t> answer(std::span<const std::uint8_t> frame, const Request& request,
                                                     Snapshot& values, AnswerRoom out);

 private:
  struct Free {
    void operator()(_modbus* context) const noexcept;
  };

  void answer_read(std::span<const std::uint8_t> frame, const Request& request, Snapshot& values);
  void answer_write(std::span<const std::uint8_t> frame, const Request& request);
  void answer_read_write(std::span<const std::uint8_t> frame, const Snapshot& values);
  [[nodiscard]] std::span<const std::uint8_t> take(AnswerRoom out);

  std::unique_ptr<_modbus, Free> context_;
  std::array<int, 2> sockets_{};  ///< What libmodbus sends to the first comes out of the second.
};

}  // namespace modbus
