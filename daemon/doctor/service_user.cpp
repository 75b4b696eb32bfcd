#include "daemon/doctor/service_user.h"

#include <grp.h>
#include <pwd.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gateway::doctor {
namespace {

constexpr int kNotTried = 255;

// Null where this program is not root, or the machine has no such user.
const passwd* service_user() {
  return ::geteuid() == 0 ? ::getpwnam(kServiceUser) : nullptr;  // NOLINT(concurrency-mt-unsafe)
}

// False: it is not, or not whole.
bool become(const passwd& user) {
  return ::initgroups(user.pw_name, user.pw_gid) == 0 && ::setgid(user.pw_gid) == 0 && ::setuid(user.pw_uid) == 0;
}

}  // namespace

bool is_service_user_known() {
  return service_user() != nullptr;
}

std::optional<int> as_service_user(const std::function<int()>& work) {
  const passwd* const user = service_user();
  const pid_t child = user == nullptr ? -1 : ::fork();
  if (child == 0) {
    ::_exit(become(*user) ? work() : kNotTried);
  }
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) == kNotTried) {
    return std::nullopt;
  }
  return WEXITSTATUS(status);
}

}  // namespace gateway::doctor
