#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <vector>

namespace mqtt {

/// Which of the brokers is tried next, and after which pause. They are tried in order; the next one at once, and when
/// each was, a new round begins with the first after a pause. A connection that breaks is made again to the same
/// broker, for it may only have been started anew. Pauses double from `first` to `longest`, each shortened at random by
/// up to half, so that many gateways do not come back to a restarted broker in one moment. Knows no time but what it is
/// given. Not thread-safe.
class Rotation {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  using Milliseconds = std::chrono::milliseconds;

  struct Pauses {
    Milliseconds first;
    Milliseconds longest;
    /// A broker that refuses us is not tried for so long; nor any after a take-over of our client id, so that what
    /// two gateways of one name do to each other stays in sight.
    Milliseconds barred;
  };
  /// How a broker's turn ended.
  enum class Outcome : std::uint8_t {
    none,        ///< No connection came about.
    refused,     ///< Nor will it before somebody mends something there: user, password, rights.
    broke,       ///< It stood for a while, and broke.
    brief,       ///< It stood, but not for long.
    silent,      ///< It stood, and the broker said nothing any more.
    taken_over,  ///< Another client has our client id, or seems to.
    left         ///< It was ended for the sake of the first broker. Where that gives none, it is made again.
  };
  /// Where so many connections in a row do not stand for long, and there is another broker, that one is tried.
  static constexpr int kBrief = 4;
  /// Likewise where so many break within kEndsWithin, however long each stood.
  static constexpr std::size_t kEnds = 5;
  static constexpr std::chrono::minutes kEndsWithin{5};

  /// `brokers`: how many, at least one.
  Rotation(std::size_t brokers, const Pauses& pauses, std::uint32_t seed);

  /// Whose turn it is.
  [[nodiscard]] std::size_t at() const noexcept { return at_; }
  /// Since the last connection not each was tried in vain.
  [[nodiscard]] bool is_first_round() const noexcept { return rounds_ == 0; }
  /// Whose turn is next is at() then; what is returned passes before it.
  Milliseconds next(Outcome outcome, TimePoint now);

 private:
  struct Place {
    bool tried = false;  ///< In this round.
    TimePoint barred_until{};
  };

  Milliseconds go_on(TimePoint now);
  [[nodiscard]] bool breaks_often(TimePoint now);
  Milliseconds begin_round(TimePoint now);
  Milliseconds next_pause();
  void forget_round();

  Pauses pauses_;
  std::vector<Place> places_;
  std::size_t at_ = 0;
  int brief_ = 0;                      ///< In a row, at this broker.
  std::deque<TimePoint> ends_{};       ///< Of its connections.
  std::optional<std::size_t> left_{};  ///< For the first; until that broke, or was followed.
  unsigned step_ = 0;                  ///< Of the pauses.
  std::size_t rounds_ = 0;             ///< Without a connection, in a row.
  std::minstd_rand random_;
};

}  // namespace mqtt
