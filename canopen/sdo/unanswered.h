#pragma once

#include <vector>

#include "canopen/clock.h"
#include "canopen/object.h"

namespace canopen {

/// The requests of an SDO client that went without an answer since one last proved that all earlier requests are over.
/// Their answers may still come: one for the same object may pass for that of a new request, and so may an abort that
/// names no object. A server answers in order, so any answer for another object is that proof.
class Unanswered {
 public:
  /// `timeout`: of one answer.
  explicit Unanswered(Duration timeout) noexcept : timeout_(timeout) {}

  /// How many answers for an object may still come at most.
  struct Count {
    unsigned all = 0;
    unsigned downloads = 0;  ///< Of those, to downloads.
    /// One of them came. Where it may have been that to an upload, only `all` is sure to be one less.
    void take_one(bool to_download) noexcept;
  };

  void note(ObjectAddress object, bool is_upload);
  /// See Count::take_one(); something of the object was noted.
  void take_one(ObjectAddress object, bool to_download) noexcept;
  /// Nothing of before may be answered any more.
  void clear() noexcept { requests_.clear(); }
  [[nodiscard]] Count count(ObjectAddress object) const noexcept;
  [[nodiscard]] bool any() const noexcept { return !requests_.empty(); }
  [[nodiscard]] bool contains(ObjectAddress object) const noexcept;
  struct Proof {
    ObjectAddress object;  ///< To be read.
    TimePoint from;        ///< Before that an answer for it, too, may be a late one.
  };
  [[nodiscard]] Proof proof() const noexcept;

 private:
  struct Request {
    ObjectAddress object;
    TimePoint at;  ///< Of the newest one.
    Count count;
  };

  Duration timeout_;
  std::vector<Request> requests_;  ///< One for each object, the oldest first.
};

}  // namespace canopen
