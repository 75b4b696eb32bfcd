#pragma once

#include "canopen/bus/socketcan/descriptor.h"

namespace canopen::socketcan {

/// A socket that becomes readable when any network interface comes, goes or changes (RTMGRP_LINK). What it says is only
/// taken as a bell: a notification may be lost (ENOBUFS), the answer to a question afterwards is always true.
/// Throws std::system_error where there is none to be had.
[[nodiscard]] Descriptor open_interface_bell();

/// Takes all that was told, so that the bell can ring again.
void silence_interface_bell(int socket) noexcept;

}  // namespace canopen::socketcan
