#pragma once

#include <boost/asio/ip/tcp.hpp>

namespace modbus {

/// Options of a client's connection. One that was cut off without a word ends 25 s after the last that was heard of it,
/// whether an answer waits for its acknowledgement or not.
void prepare(boost::asio::ip::tcp::socket& socket);

/// Linux counts a client that is there but does not read (its window is shut) as one that was cut off:
/// tcp_probe_timer() ends it though it answers each probe. As long as its window is shut it is spared.
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

}  // namespace modbus
