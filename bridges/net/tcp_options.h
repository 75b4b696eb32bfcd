#pragma once

#include <boost/asio/ip/tcp.hpp>

#include "canopen/clock.h"

namespace net {

/// Options of a client's connection. One that was cut off without a word ends 25 s after the last that was heard of it,
/// whether an answer waits for its acknowledgement or not.
void prepare(boost::asio::ip::tcp::socket& socket);

/// Since the last bytes came from it, read or not, by the system's clock; 0 where it cannot be told.
[[nodiscard]] canopen::Duration silence(boost::asio::ip::tcp::socket& socket);

/// Linux counts a client that is there but does not read (its window is shut) as one that was cut off:
/// tcp_probe_timer() ends it though it answers each probe. As long as its window is shut it is spared. Where it cannot
/// be reached any more from here (link down, address or route gone) nothing is on its way either, but its window is
/// open.
class SlowReader {
 public:
  /// Something is sent to it.
  void on_answer() noexcept { may_wait_ = true; }
  /// To be called each second.
  void look(boost::asio::ip::tcp::socket& socket);

 private:
  bool may_wait_ = false;  ///< Not all that was sent is known to be acknowledged.
  bool spared_ = false;
};

}  // namespace net
