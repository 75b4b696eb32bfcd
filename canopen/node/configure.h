#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/node/boot_result.h"
#include "canopen/node/emcy_setup.h"
#include "canopen/node/find_state.h"
#include "canopen/node/life_context.h"

namespace canopen {

/// Why a node that should answer guarding counts as one that does not.
[[nodiscard]] std::string no_guarding_text(const LifeContext& context);

/// How a configuration or an inspection went.
struct BootReport {
  BootResult letter = BootResult::ok;
  HeldBack held_back = HeldBack::no;
  std::string text;                           ///< Why it is a letter.
  std::string cause;                          ///< See BootFailure::cause.
  bool interrupted = false;                   ///< The life ended, or our frames could not leave: no verdict.
  std::vector<std::uint16_t> verified_tpdos;  ///< Their transmission type and timers are as they should be.
  std::vector<std::string> remarks;           ///< What the node lacks and was taken for granted, or what will do.
  std::optional<EmcyVerdict> emcy;            ///< Nothing: it was not asked, or did not answer.
  ErrorControlKind error_control = ErrorControlKind::none;  ///< By what the node tells that it lives.
  bool heartbeat_as_wanted = false;                         ///< 0x1017 was read so: its period is known.

  [[nodiscard]] bool ok() const noexcept { return letter == BootResult::ok && !interrupted; }
};

/// Makes a node that is not operational as wanted (after CiA 302-2 §5): identity, error control, PDOs, further
/// settings, where its emergencies go, and waits for its heartbeat or its answers to guarding. Where its state is
/// unknown: 0x1017 first and nothing else before a heartbeat told the state (the handler that hears `operational` ends
/// the life); where neither that nor guarding will ever tell it, nothing at all unless its motor is read to stand.
boost::asio::awaitable<BootReport> configure(LifeContext context, FoundState found);

/// Looks whether a node that runs is as wanted. Reads only. What would have to be changed gives
/// BootResult::left_alone, another identity its own letter; what the node lacks is no difference, nor is a heartbeat
/// time that differs but is below heartbeat_timeout.
boost::asio::awaitable<BootReport> inspect(LifeContext context);

}  // namespace canopen
