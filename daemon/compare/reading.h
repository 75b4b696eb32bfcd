#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "canopen/object.h"

namespace gateway::compare {

/// Hands a request line to the gateway and gives the line that answers it; nothing where none came, or none in time:
/// then nothing more is asked.
using Ask = std::function<std::optional<std::string>(const std::string& request)>;

/// What became of reading one object.
struct Reading {
  enum class Kind : std::uint8_t {
    value,
    absent,      ///< The drive says that it has no such object.
    unreadable,  ///< It is there, or may be; the drive refused.
    silent       ///< No answer of the drive, or of the gateway.
  };
  Kind kind = Kind::silent;
  canopen::Raw raw = 0;  ///< As the type holds it: extended by sign.
  std::string reason{};  ///< Why there is no value, for people.
};

/// Reads an object of a drive through the gateway. A drive may hold it in another width than its type has.
[[nodiscard]] Reading read_object(const Ask& ask, const std::string& drive, canopen::ObjectAddress object,
                                  canopen::DataType type);

}  // namespace gateway::compare
