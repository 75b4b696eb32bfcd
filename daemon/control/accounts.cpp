#include "daemon/control/accounts.h"

#include <grp.h>
#include <pwd.h>
#include <sys/socket.h>

#include <array>
#include <cstdio>
#include <memory>

namespace gateway::control {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

// Longer lines than any of a user; of a group with very many members.
constexpr std::size_t kLongestLine = 64UL * 1024;

}  // namespace

std::string name_of_user(uid_t user) {
  const File file(std::fopen("/etc/passwd", "re"));
  std::array<char, kLongestLine> text{};
  passwd entry{};
  passwd* found = nullptr;
  while (file && ::fgetpwent_r(file.get(), &entry, text.data(), text.size(), &found) == 0) {
    if (found->pw_uid == user) {
      return found->pw_name;
    }
  }
  return std::to_string(user);
}

std::optional<gid_t> group_of(const std::string& name) {
  const File file(std::fopen("/etc/group", "re"));
  std::array<char, kLongestLine> text{};
  group entry{};
  group* found = nullptr;
  while (file && ::fgetgrent_r(file.get(), &entry, text.data(), text.size(), &found) == 0) {
    if (name == found->gr_name) {
      return found->gr_gid;
    }
  }
  return std::nullopt;
}

std::string user_behind(int socket) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
    return "unknown";
  }
  return name_of_user(peer.uid);
}

}  // namespace gateway::control
