#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "bridges/mqtt/message.h"

namespace mqtt {

/// Messages that wait for the broker. They leave by kind, within a kind in the order in which their topics began to
/// wait. Of each topic only the newest waits, in the place of the one before, so that no topic starves; several of one
/// batch wait together where nothing did before (a pulse). One that goes after all takes a place of its own, behind all
/// that waits, and what replaces it goes after all too. Answers each count, but not for long: they are dropped, and
/// counted, when they are older than kAnswerAge, were tried on kAnswerTries connections, or are too many. Holds one
/// message per topic, one batch of pulses, and the answers. Knows no time but what it is given. Not thread-safe.
class Outbox {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::seconds kAnswerAge{10};
  static constexpr int kAnswerTries = 2;
  static constexpr std::size_t kMaxAnswers = 1000;
  static constexpr std::size_t kMaxAnswerBytes = 4UL * 1024 * 1024;  ///< Topic, payload and correlation data.

  /// A message that leaves.
  struct Item {
    Message message;
    std::uint64_t place = 0;
    TimePoint arrived{};
    int tries = 0;  ///< Connections on which it left, this one included.
  };

  /// What is held back waits as if it were not there.
  using Holds = std::function<bool(const Message&)>;

  void push(std::vector<Message> batch, TimePoint now);
  /// What pop() gives; nullptr where nothing may leave.
  [[nodiscard]] const Message* front(TimePoint now, const Holds& holds = nullptr);
  /// `may_leave`: asked of what front() gives; without leave nothing goes.
  [[nodiscard]] std::optional<Item> pop(TimePoint now, const Holds& holds = nullptr, const Holds& may_leave = nullptr);
  /// An answer that left and may not have arrived, because its connection went.
  void put_back(Item answer, TimePoint now);
  /// The next connection begins with everything that is retained.
  void forget_retained();

  [[nodiscard]] bool empty() const noexcept { return waiting_.empty(); }
  [[nodiscard]] std::size_t size() const noexcept { return waiting_.size(); }
  [[nodiscard]] std::uint64_t answers_dropped() const noexcept { return answers_dropped_; }

 private:
  using Key = std::pair<MessageKind, std::uint64_t>;  ///< The place within the kind is that among all.
  struct Waiting {
    std::deque<Message> messages;  ///< More than one: of one batch.
    std::uint64_t batch = 0;
    TimePoint arrived{};
    int tries = 0;
  };
  using Queue = std::map<Key, Waiting>;

  [[nodiscard]] Queue::iterator first(TimePoint now, const Holds& holds);
  void push_newest(Message message, TimePoint now);
  void push_answer(Message message, std::uint64_t place, TimePoint arrived, int tries);
  void drop_old_answers(TimePoint now);
  void drop_answer(Queue::iterator answer);

  Queue waiting_;
  std::unordered_map<std::string, Key> newest_;  ///< By topic.
  std::uint64_t place_ = 0;
  std::uint64_t batch_ = 0;
  std::size_t answers_ = 0;
  std::size_t answer_bytes_ = 0;
  std::uint64_t answers_dropped_ = 0;
};

}  // namespace mqtt
