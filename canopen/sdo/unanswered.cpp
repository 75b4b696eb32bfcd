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

void Unanswered::Count::take_one(bool to_download) noexcept {
  all -= std::min(all, 1U);
  downloads = std::min(all, downloads - (to_download ? std::min(downloads, 1U) : 0U));
}

void Unanswered::note(ObjectAddress object, bool is_upload) {
  Count counted = count(object);
  ++counted.all;
  counted.downloads += is_upload ? 0U : 1U;
  std::erase_if(requests_, [object](const Request& request) { return request.object == object; });
  requests_.push_back({object, Clock::now(), counted});
  if (requests_.size() > kMostKept) {
    requests_.erase(requests_.begin());
  }
}

void Unanswered::take_one(ObjectAddress object, bool to_download) noexcept {
  for (Request& request : requests_) {
    if (request.object == object) {
      request.count.take_one(to_download);
    }
  }
}

Unanswered::Count Unanswered::count(ObjectAddress object) const noexcept {
  const auto found = std::find_if(requests_.begin(), requests_.end(),
                                  [object](const Request& request) { return request.object == object; });
  return found == requests_.end() ? Count{} : found->count;
}

bool Unanswered::contains(ObjectAddress object) const noexcept {
  return count(object).all > 0;
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
