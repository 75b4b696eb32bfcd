#pragma once

#include <boost/system/result.hpp>
#include <cstdint>
#include <string>
#include <string_view>

#include "canopen/object.h"

namespace canopen {

/// Why something could not be done. What it means to a Modbus or an MQTT client stands in bridges/process/answer.h.
enum class ErrorKind : std::uint8_t {
  unknown,     ///< No such drive, signal, object or command.
  read_only,   ///< The signal takes no values.
  range,       ///< Outside of min..max or of the type.
  type,        ///< Not a value of that type; NaN and infinity too.
  incomplete,  ///< The RPDO has fields nobody commanded and the object takes no SDO.
  refused,     ///< The drive answered with an SDO abort, see Error::abort.
  timeout,     ///< No confirmation in time; Error::outcome_unknown tells whether it may have taken effect.
  offline,     ///< Drive or bus not there, booting, or not operational.
  forbidden,   ///< This writer may not, or not while running.
  lease,       ///< Another writer holds the lease.
  retained,    ///< A retained command is never carried out.
  expired,     ///< Its message expiry or deadline passed before it began.
  duplicate,   ///< The same command again.
  superseded,  ///< A later command, or a stop, came first; never sent.
  voided,      ///< What was commanded before became void while it waited; never sent.
  protocol     ///< The drive's answer makes no sense (wrong length, toggle, command specifier).
};

struct Error {
  ErrorKind kind = ErrorKind::unknown;
  std::uint8_t node = 0;         ///< 0: none.
  ObjectAddress object{};        ///< 0x0000:00: none.
  std::uint32_t abort = 0;       ///< SDO abort code (CiA 301 table 22), 0: none.
  bool outcome_unknown = false;  ///< It was begun and nobody knows whether it took effect; never repeated by us.
  bool not_sent = false;         ///< No frame of ours left: it says nothing about the drive.
  std::string detail{};          ///< What a person needs to know further; may be empty.

  friend bool operator==(const Error&, const Error&) = default;
};

/// One line for people: what happened, where, and what it means.
[[nodiscard]] std::string to_string(const Error& error);
[[nodiscard]] std::string_view name_of(ErrorKind kind) noexcept;
/// Text of an SDO abort code; "unknown abort code" where CiA 301 has none.
[[nodiscard]] std::string_view abort_text(std::uint32_t code) noexcept;

template <class T>
using Result = boost::system::result<T, Error>;

/// The node has no such object or sub-index, as it says itself (CiA 301 table 22).
[[nodiscard]] bool is_absent(const Error& error) noexcept;

[[noreturn]] void throw_exception_from_error(const Error& error, const boost::source_location& where);

}  // namespace canopen
