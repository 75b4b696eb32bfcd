#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "bridges/process/image.h"
#include "bridges/process/writer.h"
#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/object.h"

namespace process {

/// Who asks for something, and since when.
struct Origin {
  Writer writer;
  std::string id{};                                        ///< Given by the client; empty: the arbiter makes one.
  canopen::TimePoint received = canopen::Clock::now();     ///< Not earlier; the deadline counts from here.
  canopen::TimePoint received_until{};                     ///< Not later, where that is not the same moment.
  canopen::TimePoint expires = canopen::TimePoint::max();  ///< Not begun by then: `expired`.
};

/// What became of a command.
struct Outcome {
  std::optional<canopen::Error> failure{};  ///< Nothing: confirmed.
  std::string id{};                         ///< Its name in the journal, the answer and the log.
  std::size_t written = 0;                  ///< Fields that were confirmed, also where a later one failed.
  bool unchanged = false;                   ///< The drive was known to hold all of it already.
  std::string note{};                       ///< What a person should know of a confirmed one; may be empty.

  Outcome() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): an error is the usual outcome of a check.
  Outcome(canopen::Error error) : failure(std::move(error)) {}
  Outcome(const canopen::Result<void>& result) {  // NOLINT(google-explicit-constructor): likewise
    if (result.has_error()) {
      failure = result.error();
    }
  }
  [[nodiscard]] bool has_value() const noexcept { return !failure; }
  [[nodiscard]] bool has_error() const noexcept { return failure.has_value(); }
  [[nodiscard]] const canopen::Error& error() const { return failure.value(); }
};

/// Some bits of a word (Modbus function 22): (word AND and_mask) OR (or_mask AND NOT and_mask). Which word, the arbiter
/// knows.
struct Mask {
  std::uint16_t and_mask = 0;
  std::uint16_t or_mask = 0;

  [[nodiscard]] constexpr std::uint16_t applied_to(std::uint16_t word) const noexcept {
    return static_cast<std::uint16_t>((word & and_mask) | (or_mask & ~and_mask));
  }
  friend bool operator==(const Mask&, const Mask&) = default;
};

/// A raw value comes from a Modbus register (already in the signal's type, sign-extended), a number in engineering
/// units from everywhere else.
using GivenValue = std::variant<canopen::Raw, double, Mask>;

/// One signal of a command.
struct FieldWrite {
  SignalId signal = 0;
  GivenValue value;
};

}  // namespace process
