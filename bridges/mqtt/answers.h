#pragma once

#include <optional>
#include <string>

#include "bridges/mqtt/message.h"
#include "bridges/process/command.h"
#include "canopen/error.h"
#include "canopen/object.h"

namespace mqtt {

/// Where an answer goes and what it echoes.
struct ReplyTo {
  std::string topic{};  ///< To publish to.
  std::optional<std::string> correlation{};
  std::string command_topic{};  ///< Of the command.
  std::string id{};             ///< As JSON text; empty: none.
};

/// `{"ok":true,"topic":"…","id":"a1"}` or `{"ok":false,"code":"range","error":"…","topic":"…"}`.
[[nodiscard]] Message command_answer(const ReplyTo& to, const process::Outcome& outcome);

/// `{"id":"7","ok":true,"value":0}`; the value of a write is left out. `type` is that of the value.
[[nodiscard]] Message sdo_answer(const ReplyTo& to, const canopen::Result<std::optional<canopen::Raw>>& outcome,
                                 canopen::DataType type);

}  // namespace mqtt
