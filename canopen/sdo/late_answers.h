#pragma once

#include <optional>
#include <vector>

#include "canopen/clock.h"
#include "canopen/object.h"

namespace canopen {

/// Which requests of an SDO client went unanswered, so that their answers may still come and pass for those of later
/// requests for the same object.
class LateAnswers {
 public:
  /// A request for `object` had no answer within `timeout`.
  void note_unanswered(ObjectAddress object, Duration timeout);
  /// A request was answered. For an object without unanswered requests that ends the wait for all others: a server
  /// answers in order. For one with such requests it may be the answer to any of them.
  void note_answered(ObjectAddress object, bool was_read);
  /// An answer to an earlier request for `object` may still come.
  [[nodiscard]] bool expected(ObjectAddress object);
  /// An object that this node let us read before, and of which no late answer is expected.
  [[nodiscard]] std::optional<ObjectAddress> readable();

 private:
  struct Unanswered {
    ObjectAddress object;
    TimePoint until;  ///< Its answer is no longer expected then.
  };

  std::vector<Unanswered> unanswered_;
  std::vector<ObjectAddress> readable_;
};

}  // namespace canopen
