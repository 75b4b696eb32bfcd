#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "bridges/mqtt/attempts.h"
#include "bridges/mqtt/errand.h"
#include "config/model.h"

namespace mqtt {

/// The addresses of a broker's name: asked for ahead, while nobody waits for them, and those of last time where a name
/// server says nothing. Each question has a thread of its own, one at a time, which may hang for as long as it likes.
/// Not thread-safe.
class BrokerAddresses {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  /// So often a name is asked for ahead.
  static constexpr std::chrono::minutes kAhead{5};
  /// What a question that nobody waited for came to counts for so long; an older one is asked anew.
  static constexpr std::chrono::seconds kAge{30};

  BrokerAddresses(config::Endpoint broker, Resolver resolver);

  /// Asks where that is due, and notes what came of it. Never blocks.
  void ask_ahead(TimePoint now);
  /// Asks now, where it is not asked already.
  void ask();
  /// The question was answered, be it with nothing; waits for that as long.
  [[nodiscard]] bool is_answered(std::chrono::milliseconds patience = {});

  /// What the last answer was that told any; empty: none did yet.
  [[nodiscard]] const std::vector<std::string>& known() const noexcept { return known_; }
  /// The last question was answered with addresses.
  [[nodiscard]] bool are_new() const noexcept { return are_new_; }
  /// What a connection may be tried at. With TLS Paho gets the name, which the certificate must be for, and takes the
  /// address that the system gives; while it waits for that nothing else can be asked of it. So such a name is only
  /// given to it where it was answered just now.
  [[nodiscard]] std::vector<std::string> to_try() const;
  /// Nobody has to be asked before a connection is tried.
  [[nodiscard]] bool can_do_without() const noexcept { return !broker_.tls && !known_.empty(); }
  /// There is another machine behind this name. One address of IPv4 and one of IPv6 are two ways to the same.
  [[nodiscard]] bool are_of_several() const;

 private:
  void begin();

  config::Endpoint broker_;
  Resolver resolver_;
  Errand<std::vector<std::string>> look_up_;
  std::vector<std::string> known_;
  bool are_new_ = false;
  TimePoint ahead_at_ = TimePoint::min();  ///< When it is asked for ahead.
};

}  // namespace mqtt
