#pragma once

namespace gateway {

/// For a program that may be put into the background: from there neither reading nor writing the terminal stops it.
/// Reading fails then, and may_read_terminal() tells before.
void outlive_job_control();

/// The descriptor is no terminal, or its terminal is ours: this process is in the foreground of it.
[[nodiscard]] bool may_read_terminal(int descriptor);

/// The same terminal, pipe or FIFO by a descriptor of our own that does not block, so that whoever shares the other one
/// does not find it changed; -1 where that cannot be had: a file, a socket, a terminal that belongs to somebody else.
/// `access`: O_RDONLY or O_WRONLY.
[[nodiscard]] int reopen(int descriptor, int access);

}  // namespace gateway
