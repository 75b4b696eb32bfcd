#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <system_error>

#include "canopen/frame.h"
#include "config/model.h"
#include "daemon/doctor/line.h"
#include "daemon/doctor/presence.h"

namespace gateway::doctor {

/// What was heard on a bus, without a word of ours.
struct Hearing {
  std::uint64_t frames = 0;
  std::uint64_t errors = 0;       ///< Error frames of the driver that tell of an error on the wire.
  std::array<bool, 128> nodes{};  ///< Whose frames were heard, by the predefined connection set (CiA 301 §7.3.5).
  std::array<bool, 128> asked{};  ///< To whom SDO requests were sent.
  bool nmt = false;
  bool sync = false;

  void add(const canopen::Frame& frame) noexcept;
};

/// What it is compared with.
struct Listened {
  std::chrono::milliseconds time{};
  Presence gateway = Presence::absent;  ///< Else heartbeat, NMT, SYNC and requests may be its own.
};

/// How long to listen on a bus: what a drive that lives may be silent (heartbeat_timeout), from 3 s to a minute.
[[nodiscard]] std::chrono::milliseconds listening_time(const config::Model& model, std::size_t bus);

/// Listens on the interface, which is up. `failed`: why it could not.
[[nodiscard]] Hearing listen(const std::string& interface, std::chrono::milliseconds time, std::error_code& failed);
[[nodiscard]] Lines judge(const config::Model& model, std::size_t bus, const Hearing& hearing,
                          const Listened& listened);

}  // namespace gateway::doctor
