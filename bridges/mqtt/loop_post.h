#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "bridges/mqtt/message.h"
#include "bridges/mqtt/notice.h"

namespace mqtt {

/// Brings what any thread tells to the loop, in order, many in one turn. Bounded: of commands that the loop does not
/// get to, those beyond kMaxMessages or kMaxBytes are dropped, counted, and their number is told. Stops have as much
/// room again; beyond that too, one is dropped only where another stop on its topic waits already, with no command
/// behind it. What others write on topics that are watched costs no command its place: of each topic only the newest is
/// brought, in the place of the first, up to kMaxTopics; beyond kMaxBytes without its payload. A stop among
/// them is a command.
class LoopPost : public std::enable_shared_from_this<LoopPost> {
 public:
  static constexpr std::size_t kMaxMessages = 1000;
  /// Of what is watched: more than a large plant has, for all that the broker keeps of it comes at once.
  static constexpr std::size_t kMaxTopics = 10'000;
  static constexpr std::size_t kMaxBytes = 4UL * 1024 * 1024;
  using Call = std::function<void()>;
  using Receiver = std::function<void(Incoming&&)>;
  using IsStop = std::function<bool(const Incoming&)>;

  LoopPost(boost::asio::any_io_executor executor, Receiver receiver, Notice notice)
      : executor_(std::move(executor)), receiver_(std::move(receiver)), notice_(std::move(notice)) {}

  /// Before the first post(): tells stops from other commands. Called on any thread, not after close().
  void tell_stops_by(IsStop is_stop);
  /// From any thread; does nothing after close().
  void post(Call call);
  /// A command, likewise.
  void post_message(Incoming message);
  /// A message on a topic that is watched, likewise.
  void post_watched(Incoming message);
  /// On the loop: nothing arrives any more. The loop may be gone afterwards.
  void close();

 private:
  using Event = std::variant<Call, Incoming>;

  void add(Event event);
  void drain();
  /// False: it is one too many.
  [[nodiscard]] bool admit(const Incoming& message);
  [[nodiscard]] bool admit_stop(const Incoming& stop, std::size_t size);

  std::mutex mutex_;
  std::optional<boost::asio::any_io_executor> executor_;  ///< Nothing after close().
  std::vector<Event> events_;
  /// What was posted since the loop came last.
  struct Load {
    std::size_t messages = 0;
    std::size_t bytes = 0;
    bool full = false;  ///< A command was dropped: none that comes later goes in its place.
    std::size_t stops = 0;
    std::size_t stop_bytes = 0;
    std::set<std::string> stops_on;  ///< Topics of the stops that came since it is full.
    std::size_t dropped = 0;
    std::map<std::string, std::size_t> watched;  ///< Where in events_ the newest of each topic is.
    std::size_t watched_bytes = 0;
  };
  Load load_;
  IsStop is_stop_;
  Receiver receiver_;  ///< Used on the loop only.
  Notice notice_;      ///< Likewise.
};

}  // namespace mqtt
