#include "canopen/sdo/unanswered.h"

#include <algorithm>
#include <array>

#include "canopen/communication_objects.h"

namespace canopen {
namespace {

// Every node has them (CiA 301 §7.5.2); where not, the abort is an answer, too.
constexpr std::array kProofs{kDeviceType, kProducerHeartbeat};
// A silent node is asked for them in turn: an answer that has not come after that many times the timeout never will.
constexpr int kLateTimeouts = 4;
// Of more objects than that the oldest are forgotten: as many later requests went unanswered.
constexpr std::size_t kMostKept = 16;

}  // namespace

void Unanswered::note(ObjectAddress object) {
  std::erase_if(requests_, [object](const Request& request) { return request.object == object; });
  requests_.push_back({object, Clock::now()});
  if (requests_.size() > kMostKept) {
    requests_.erase(requests_.begin());
  }
}

bool Unanswered::contains(ObjectAddress object) const noexcept {
  return std::any_of(requests_.begin(), requests_.end(),
                     [object](const Request& request) { return request.object == object; });
}

Unanswered::Proof Unanswered::proof() const noexcept {
  const auto* const fresh =
      std::find_if(kProofs.begin(), kProofs.end(), [this](ObjectAddress object) { return !contains(object); });
  if (fresh != kProofs.end()) {
    return {*fresh, TimePoint::min()};
  }
  const auto oldest = std::find_if(requests_.begin(), requests_.end(), [](const Request& request) {
    return std::find(kProofs.begin(), kProofs.end(), request.object) != kProofs.end();
  });
  return {oldest->object, oldest->at + kLateTimeouts * timeout_};
}

}  // namespace canopen
