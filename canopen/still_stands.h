#pragma once

#include <functional>

namespace canopen {

/// Whether what a command was made from still stands: others may have been before it, or the drive stopped. Asked when
/// the command has its turn, and again right before it leaves. Empty: it was made from nothing.
using StillStands = std::function<bool()>;

}  // namespace canopen
