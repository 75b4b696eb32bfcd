#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/system/error_code.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace net {

/// Asks the system for the addresses of a name to listen on. The system cannot be interrupted and may take half a
/// minute, so a thread of its own waits for it that nobody waits for: Asio's resolver would keep the end of the
/// program.
class LookUp {
 public:
  using Endpoints = std::vector<boost::asio::ip::tcp::endpoint>;
  using Answered = std::function<void(const boost::system::error_code&, Endpoints)>;

  /// `answered` is called in `executor`, unless this is gone by then. Throws std::system_error where there is no thread
  /// to be had.
  LookUp(const boost::asio::any_io_executor& executor, std::string name, std::uint16_t port, Answered answered);
  ~LookUp();
  LookUp(const LookUp&) = delete;
  LookUp& operator=(const LookUp&) = delete;

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;  ///< With the thread, which may outlive this.
};

}  // namespace net
