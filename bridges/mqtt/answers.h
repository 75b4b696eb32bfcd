#pragma once

#include <optional>
#include <string>

#include "bridges/mqtt/message.h"
#include "bridges/mqtt/sdo_request.h"
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
  bool sdo = false;             ///< In the form of answers to SDO requests: id first, no topic.
};

/// `{"ok":true,"topic":"…","id":"a1"}` or `{"ok":false,"code":"range","error":"…","topic":"…"}`. Where the client gave
/// no id, that of the outcome stands there. `"unchanged":true` and `"note"` are there where there is such a thing to
/// say.
[[nodiscard]] Message command_answer(const ReplyTo& to, const process::Outcome& outcome);

/// What became of a command, as it stands in the answers to its repetitions: `{"ok":true}` or
/// `{"ok":false,"code":"refused","abort":"0x08000022","error":"…"}`.
[[nodiscard]] std::string first_outcome(const process::Outcome& outcome);

/// What a repetition is refused with.
[[nodiscard]] canopen::Error duplicate_error();

/// To a repetition: code `duplicate`, with `first` beside it where it is given.
[[nodiscard]] Message duplicate_answer(const ReplyTo& to, const std::optional<std::string>& first);

/// To a read: `{"id":"7","ok":true,"value":0}`. `type` is that of the value.
[[nodiscard]] Message sdo_answer(const ReplyTo& to, const canopen::Result<canopen::Raw>& read, canopen::DataType type);
/// The same of text or bytes: `{"id":"7","ok":true,"value":"AC310"}`.
[[nodiscard]] Message sdo_answer(const ReplyTo& to, const canopen::Result<std::vector<std::uint8_t>>& read,
                                 SdoForm form);

}  // namespace mqtt
