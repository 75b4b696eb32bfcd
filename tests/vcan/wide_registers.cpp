// Preloaded into the user-mode kernel of tests/vcan/run.
//
// Linux takes a traced process' extended registers only as a whole (PTRACE_SETREGSET of NT_X86_XSTATE fails with
// EFAULT otherwise), and the user-mode kernel 6.1 keeps no more of them than AVX-512 needs. On a processor with AMX
// every switch to a process would fail. The missing rest is in its initial state in every process of the guest, since
// its kernel grants nobody AMX: append it.
#include <dlfcn.h>
#include <elf.h>
#include <errno.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/uio.h>

namespace {

using Ptrace = long (*)(int, pid_t, void*, void*);

// The user-mode kernel is one thread.
alignas(64) unsigned char whole[65536];
size_t whole_size = 0;

long set_registers(Ptrace next, pid_t pid, void* kind, iovec* part) {
  if (whole_size == 0) {
    const long result = next(PTRACE_SETREGSET, pid, kind, part);
    if (result == 0 || errno != EFAULT) {
      return result;
    }
    iovec all{whole, sizeof whole};
    if (next(PTRACE_GETREGSET, pid, kind, &all) != 0) {
      return -1;
    }
    whole_size = all.iov_len;
  }
  if (part->iov_len > whole_size) {
    errno = EFAULT;
    return -1;
  }
  memcpy(whole, part->iov_base, part->iov_len);
  iovec all{whole, whole_size};
  return next(PTRACE_SETREGSET, pid, kind, &all);
}

}  // namespace

extern "C" long ptrace(__ptrace_request request, ...) noexcept {
  static const Ptrace next = reinterpret_cast<Ptrace>(dlsym(RTLD_NEXT, "ptrace"));
  va_list arguments;
  va_start(arguments, request);
  const pid_t pid = va_arg(arguments, pid_t);
  void* const address = va_arg(arguments, void*);
  void* const data = va_arg(arguments, void*);
  va_end(arguments);
  if (request == PTRACE_SETREGSET && reinterpret_cast<uintptr_t>(address) == NT_X86_XSTATE) {
    return set_registers(next, pid, address, static_cast<iovec*>(data));
  }
  return next(request, pid, address, data);
}
