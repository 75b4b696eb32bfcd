#pragma once

#include <sys/types.h>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <filesystem>
#include <optional>
#include <string>

namespace gateway::control {

/// Where clients find us, and who may.
struct Place {
  std::filesystem::path path;  ///< Its directory is there already.
  /// Of the socket, where the machine has a group of this name; empty: that of the process.
  std::string group;
};

/// Which file it is, whatever its name.
struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;
  friend bool operator==(const FileIdentity&, const FileIdentity&) = default;
};

/// A listening socket, or why there is none.
struct Opened {
  std::optional<boost::asio::local::stream_protocol::acceptor> acceptor;
  FileIdentity file;
  std::string problem;  ///< With its remedy; empty: it listens.
  std::string remark;   ///< It listens, but not quite as wanted.
};

/// Listens at the place, mode 0660. A socket file that a dead process left is replaced; whatever else stands there is
/// not touched.
[[nodiscard]] Opened listen_at(const boost::asio::any_io_executor& executor, const Place& place);

/// Removes the socket file, unless another has taken its place.
void remove_socket(const std::filesystem::path& path, const FileIdentity& file);

}  // namespace gateway::control
