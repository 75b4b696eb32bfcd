#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "canopen/sdo/frames.h"

namespace canopen {

/// Recognises a further answer to a request that had its answer already: no single server sends one. A plain value.
class SecondAnswer {
 public:
  enum class Verdict : std::uint8_t {
    none,      ///< It may be an answer to something else.
    further,   ///< What the first one said, or of an object whose value may have changed. CAN itself may double a frame
               ///< when its last bit is disturbed: the answer, or the request.
    different  ///< Of an object that never changes (0x1000, 0x1018) something else: two servers answer.
  };

  /// A request that was sent once, with nothing else unanswered and nobody else asking, has its answer.
  void on_answered(std::span<const std::uint8_t> answer) noexcept;
  /// Another request for that object is about to leave, by us or by somebody else.
  void forget() noexcept { first_.reset(); }
  void on_request(ObjectAddress object) noexcept;
  /// Of an answer that nobody took.
  [[nodiscard]] Verdict judge(std::span<const std::uint8_t> answer) const noexcept;

 private:
  struct First {
    ObjectAddress object;
    SdoFrame answer{};
    std::size_t size = 0;
  };
  std::optional<First> first_;
};

}  // namespace canopen
