#pragma once

#include <boost/asio/ip/address.hpp>
#include <cstddef>
#include <map>

namespace gateway::http {

/// Bytes of answers that wait for their clients. Small answers are never refused: so many as there are connections
/// bound them. Large ones are, so that whoever does not take his keeps nobody else from theirs.
class WaitingBytes {
 public:
  static constexpr std::size_t kSmall = 64UL * 1024;
  /// Of one address, beyond a single answer.
  static constexpr std::size_t kMostOfAddress = 8UL * 1024 * 1024;
  /// Of all together, beyond small ones.
  static constexpr std::size_t kMost = 32UL * 1024 * 1024;

  /// Whether an answer to this address, of which `held` bytes are among these already, may have `size` bytes.
  [[nodiscard]] bool has_room(const boost::asio::ip::address& address, std::size_t held, std::size_t size) const {
    const auto found = by_address_.find(address);
    const std::size_t others = (found == by_address_.end() ? 0 : found->second) - held;
    return size <= kSmall || (all_ - held + size <= kMost && (others == 0 || others + size <= kMostOfAddress));
  }
  void add(const boost::asio::ip::address& address, std::size_t bytes) {
    if (bytes != 0) {
      all_ += bytes;
      by_address_[address] += bytes;
    }
  }
  void remove(const boost::asio::ip::address& address, std::size_t bytes) {
    const auto found = by_address_.find(address);
    if (found == by_address_.end()) {
      return;
    }
    all_ -= bytes;
    found->second -= bytes;
    if (found->second == 0) {
      by_address_.erase(found);
    }
  }

 private:
  std::size_t all_ = 0;
  std::map<boost::asio::ip::address, std::size_t> by_address_;
};

}  // namespace gateway::http
