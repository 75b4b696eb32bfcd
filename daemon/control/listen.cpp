#include "daemon/control/listen.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <boost/system/error_code.hpp>
#include <cerrno>
#include <cstring>
#include <utility>

#include "daemon/control/accounts.h"

namespace gateway::control {
namespace {

using boost::asio::local::stream_protocol;
using boost::system::error_code;

constexpr mode_t kOwnerOnly = 0600;
constexpr mode_t kOwnerAndGroup = 0660;

std::string why(int error) {
  return error_code(error, boost::system::system_category()).message();
}

// Whether nobody listens at the socket that stands there: the process that made it is dead.
bool is_left_behind(const boost::asio::any_io_executor& executor, const stream_protocol::endpoint& at) {
  stream_protocol::socket probe(executor);
  error_code failed;
  probe.open(stream_protocol(), failed);
  if (!failed) {
    probe.non_blocking(true, failed);  // one that listens and has no place left is not waited for
  }
  if (!failed) {
    probe.connect(at, failed);
  }
  return failed == boost::asio::error::connection_refused;
}

// What keeps the path from being taken; empty where nothing does any more.
std::string make_way(const boost::asio::any_io_executor& executor, const std::string& path) {
  struct stat found{};
  if (::lstat(path.c_str(), &found) != 0) {
    return {};  // nothing there, or bind tells better
  }
  if (!S_ISSOCK(found.st_mode)) {
    return "a file that is no socket stands there: remove it, or name another path";
  }
  if (!is_left_behind(executor, stream_protocol::endpoint(path))) {
    return "another process listens there: stop it, or name another path";
  }
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) {
    return "the socket of a dead process stands there and cannot be removed: " + why(errno);
  }
  return {};
}

std::string remedy(int error, const std::filesystem::path& path) {
  if (error == ENOENT) {
    return "the directory " + path.parent_path().string() +
           " is not there; systemd makes the usual one (RuntimeDirectory), any other has to be made";
  }
  if (error == EACCES || error == EPERM || error == EROFS) {
    return "the user of the gateway must be able to write to " + path.parent_path().string();
  }
  return "name another path";
}

// Before it listens nobody can connect, so mode and group are right before anybody can. The file has the group of the
// process: where that is the wanted one already nothing is asked of a system that may forbid it to a service.
std::string give_to_group(const std::string& path, gid_t group_now, const std::string& name) {
  std::string remark;
  const std::optional<gid_t> group = name.empty() ? std::nullopt : group_of(name);
  if (group && *group != group_now && ::lchown(path.c_str(), static_cast<uid_t>(-1), *group) != 0) {
    remark = "cannot be given to the group " + name + ": " + why(errno) + "; it is for the gateway's own group";
  }
  if (::chmod(path.c_str(), kOwnerAndGroup) != 0) {
    remark = "its mode cannot be set to 0660: " + why(errno) + "; it is for the gateway's own user";
  }
  return remark;
}

}  // namespace

Opened listen_at(const boost::asio::any_io_executor& executor, const Place& place) {
  Opened opened;
  const std::string path = place.path.string();
  if (path.size() >= sizeof(sockaddr_un::sun_path)) {
    opened.problem = "the path is longer than " + std::to_string(sizeof(sockaddr_un::sun_path) - 1) + " bytes";
    return opened;
  }
  opened.problem = make_way(executor, path);
  if (!opened.problem.empty()) {
    return opened;
  }
  stream_protocol::acceptor acceptor(executor);
  error_code failed;
  acceptor.open(stream_protocol(), failed);
  if (!failed) {
    ::fchmod(acceptor.native_handle(), kOwnerOnly);  // Linux makes the file with this mode, whatever the umask
    acceptor.bind(stream_protocol::endpoint(path), failed);
  }
  if (failed) {
    opened.problem = failed.message() + ": " + remedy(failed.value(), place.path);
    return opened;
  }
  struct stat made{};
  if (::lstat(path.c_str(), &made) == 0) {
    opened.file = {made.st_dev, made.st_ino};
  }
  opened.remark = give_to_group(path, made.st_gid, place.group);
  acceptor.listen(boost::asio::socket_base::max_listen_connections, failed);
  if (failed) {
    opened.problem = failed.message();
    return opened;
  }
  opened.acceptor = std::move(acceptor);
  return opened;
}

void remove_socket(const std::filesystem::path& path, const FileIdentity& file) {
  struct stat found{};
  if (::lstat(path.c_str(), &found) == 0 && FileIdentity{found.st_dev, found.st_ino} == file) {
    ::unlink(path.c_str());
  }
}

}  // namespace gateway::control
