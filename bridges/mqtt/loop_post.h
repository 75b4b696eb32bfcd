#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <variant>
#include <vector>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/message.h"
#include "bridges/mqtt/notice.h"

namespace mqtt {

/// What the publisher's threads tell the loop. They own what they tell.
struct Connected {
  ConnectionId connection = 0;
};
struct Disconnected {};
struct Subscribed {
  bool granted = true;
};
struct Said {
  Level level = Level::info;
  std::string text;
};
struct Ended {};
using LoopEvent = std::variant<Connected, Disconnected, Subscribed, Said, Ended, Incoming>;

/// Brings events from any thread to the loop, in order, many in one turn. Bounded: commands that the loop does not get
/// to are dropped beyond kMaxMessages or kMaxBytes, and counted.
class LoopPost : public std::enable_shared_from_this<LoopPost> {
 public:
  static constexpr std::size_t kMaxMessages = 1000;
  static constexpr std::size_t kMaxBytes = 4UL * 1024 * 1024;
  using Receiver = std::function<void(LoopEvent&)>;

  LoopPost(boost::asio::any_io_executor executor, Receiver receiver)
      : executor_(std::move(executor)), receiver_(std::move(receiver)) {}

  /// From any thread; does nothing after close().
  void post(LoopEvent event);
  /// On the loop: nothing arrives any more. The loop may be gone afterwards.
  void close();

 private:
  void drain();
  /// False: it is one too many.
  [[nodiscard]] bool admit(const LoopEvent& event);

  std::mutex mutex_;
  std::optional<boost::asio::any_io_executor> executor_;  ///< Nothing after close().
  std::vector<LoopEvent> events_;
  std::size_t messages_ = 0;
  std::size_t bytes_ = 0;
  std::size_t dropped_ = 0;
  Receiver receiver_;  ///< Used on the loop only.
};

}  // namespace mqtt
