#include "canopen/sdo/budget.h"

#include <algorithm>
#include <utility>

namespace canopen {
namespace {

const std::uint32_t kBitsOfFrame = bits_on_wire({.size = 8});
// A request and its answer.
const std::uint32_t kBitsOfTransfer = 2 * kBitsOfFrame;
// Of transfers that run at once all answers may come together, and hold other frames up for so long.
constexpr std::uint32_t kBitrateOfOne = 16'000;
constexpr std::size_t kFewestAtOnce = 4;
constexpr std::size_t kMostAtOnce = 64;
// Drives answer within milliseconds. After that time one is slow or silent.
constexpr Duration kAnswerTime = std::chrono::milliseconds(50);
constexpr int kTransfersBeforeAnswer = 8;
constexpr Duration kMostDebt = std::chrono::milliseconds(500);

Duration time_of_bits(std::uint64_t bits, double bits_per_second) noexcept {
  return std::chrono::duration_cast<Duration>(
      std::chrono::duration<double>(static_cast<double>(bits) / bits_per_second));
}

}  // namespace

SdoBudget::Claim::Claim(SdoBudget& budget, TimePoint due, std::function<void()> on_granted)
    : budget_(budget), due_(due), on_granted_(std::move(on_granted)) {
  budget_.add(*this);
}

SdoBudget::Claim::~Claim() {
  budget_.remove(*this);
}

SdoBudget::SdoBudget(const boost::asio::any_io_executor& executor, std::optional<std::uint32_t> bitrate,
                     double most_load, BusLoad& load)
    : most_load_(most_load),
      load_(load),
      answer_time_(kAnswerTime),
      wake_up_(executor, [this] { grant_what_may_be(); }) {
  if (bitrate) {
    set_bitrate(*bitrate);
  }
}

void SdoBudget::set_bitrate(std::uint32_t bitrate) {
  bitrate_ = bitrate;
  most_at_once_ = std::clamp<std::size_t>(bitrate / kBitrateOfOne, kFewestAtOnce, kMostAtOnce);
  answer_time_ = kAnswerTime + kTransfersBeforeAnswer * time_of_bits(kBitsOfTransfer, bitrate);
}

void SdoBudget::charge(unsigned frames) {
  if (bitrate_) {
    const TimePoint now = Clock::now();
    // Commands are not limited, and must not keep boots and polls out for ever.
    paid_until_ = std::min(std::max(paid_until_, now) + time_of(frames, now), now + kMostDebt);
  }
}

void SdoBudget::add(Claim& claim) {
  const auto place = std::upper_bound(waiting_.begin(), waiting_.end(), claim.due_,
                                      [](TimePoint due, const Claim* other) { return due < other->due_; });
  waiting_.insert(place, &claim);
  const TimePoint now = Clock::now();
  if (waiting_.size() == 1 && may_grant(now)) {
    grant_next(now);
  }
  arm();
}

void SdoBudget::remove(Claim& claim) {
  std::erase(waiting_, &claim);
  std::erase(granted_, &claim);
  arm();
}

bool SdoBudget::may_grant(TimePoint now) {
  std::erase_if(granted_, [now](const Claim* claim) { return claim->counts_until_ <= now; });
  return !waiting_.empty() && granted_.size() < most_at_once_ && paid_until_ <= now + kAhead;
}

void SdoBudget::grant_next(TimePoint now) {
  Claim& claim = *waiting_.front();
  waiting_.erase(waiting_.begin());
  claim.granted_ = true;
  claim.counts_until_ = now + answer_time_;
  granted_.push_back(&claim);
  charge();
}

void SdoBudget::grant_what_may_be() {
  const TimePoint now = Clock::now();
  while (may_grant(now)) {
    const Claim& claim = *waiting_.front();
    grant_next(now);
    claim.on_granted_();
  }
  arm();
}

// Through the loop also where it may be at once: who gives a place back is not to be called from inside.
void SdoBudget::arm() {
  if (waiting_.empty()) {
    wake_up_.cancel();
    return;
  }
  TimePoint next = paid_until_ - kAhead;
  if (granted_.size() >= most_at_once_) {
    next = std::max(next, granted_.front()->counts_until_);
  }
  wake_up_.arm(next);
}

Duration SdoBudget::time_of(unsigned frames, TimePoint now) {
  const double others = load_.others_per_mille(*bitrate_, now) / 1000.0;
  const double share = std::max(most_load_ - others, kLeastShare);
  return time_of_bits(std::uint64_t{frames} * kBitsOfFrame, share * *bitrate_);
}

}  // namespace canopen
