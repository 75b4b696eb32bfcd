#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <optional>
#include <string_view>
#include <unordered_map>

#include "bridges/mqtt/message.h"

namespace mqtt {

/// Messages that wait for the broker: first in, first out up to `limit`; then only the newest per topic in the place of
/// the one before, so that no topic starves. While held too there is one per topic, but in the order in which they came
/// last: what was announced before a connection broke and is announced again keeps its order. Values and alarms have a
/// limit of their own each, so that no flood of values costs an alarm. Answers are each kept; of more than `limit` the
/// oldest is lost. Never holds more than 3 · limit messages plus one per topic. Not thread-safe.
class Outbox {
 public:
  explicit Outbox(std::size_t limit) : limit_(limit) {}

  void push(Message message);
  /// An answer that was under way when the connection went goes before all others.
  void put_back(Message answer);
  std::optional<Message> pop();

  /// While held only the newest per topic is kept, of what waits already too.
  void hold(bool held);

  [[nodiscard]] bool empty() const noexcept { return queue_.empty(); }
  [[nodiscard]] std::size_t size() const noexcept { return queue_.size(); }
  [[nodiscard]] std::uint64_t lost_answers() const noexcept { return lost_answers_; }

 private:
  using Queue = std::list<Message>;

  [[nodiscard]] std::size_t& count_of(MessageKind kind) noexcept;
  void drop_oldest_answer();
  void erase(Queue::iterator message);

  std::size_t limit_;
  bool held_ = false;
  Queue queue_;
  /// The newest value or alarm of each topic; the keys point into the queue.
  std::unordered_map<std::string_view, Queue::iterator> newest_;
  std::size_t values_ = 0;
  std::size_t alarms_ = 0;
  std::size_t answers_ = 0;
  std::uint64_t lost_answers_ = 0;
};

}  // namespace mqtt
