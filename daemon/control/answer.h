#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/mqtt/sdo_request.h"
#include "bridges/process/command.h"
#include "bridges/process/stop_all.h"
#include "canopen/error.h"
#include "canopen/object.h"

// Answers, each one JSON object without a line break. `id` is JSON text.

namespace gateway::control {

/// `{"id":7,"ok":false,"code":"refused","abort":"0x06020000","error":"…"}`
[[nodiscard]] std::string refusal(std::string_view id, const canopen::Error& error);

/// `{"id":7,"ok":true,"unchanged":true,"note":"…","command":"…"}`, the members from the third on where they say
/// something; or a refusal, with `command` likewise.
[[nodiscard]] std::string told_outcome(std::string_view id, const process::Outcome& outcome);

/// `{"id":7,"ok":true,"value":0}`, as the device holds it.
[[nodiscard]] std::string read_value(std::string_view id, canopen::DataType type, canopen::Raw raw);
/// The same of text or bytes.
[[nodiscard]] std::string read_data(std::string_view id, mqtt::SdoForm form, const std::vector<std::uint8_t>& data);

/// `{"id":7,"ok":true,"stopped":2}`, or a refusal that names those of the `asked` drives that did not confirm.
[[nodiscard]] std::string stop_answer(std::string_view id, std::size_t asked,
                                      std::span<const process::NotStopped> not_stopped);

/// `{"id":7,"ok":true,"status":{…}}`; `status` is JSON text.
[[nodiscard]] std::string told_status(std::string_view id, std::string_view status);

/// The same of `buses`: a list.
[[nodiscard]] std::string told_buses(std::string_view id, std::string_view buses);

}  // namespace gateway::control
