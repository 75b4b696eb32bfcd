#include "bridges/trace/feed.h"

#include <utility>

namespace trace {

/// The frames of one bus.
class Feed::Tap final : public canopen::FrameTap {
 public:
  Tap(Feed& feed, canopen::Bus& bus, std::size_t index)
      : feed_(feed), decoder_(feed.model_, index), subscription_(bus.add_tap(*this)) {}

  void on_frame(const canopen::Received& received, canopen::FrameOrigin origin) override {
    newest_ = received.wall;
    feed_.push(decoder_.decode(received.frame, received.wall, origin));
  }
  void on_frames_lost(std::uint32_t count) override { feed_.push(decoder_.lose(count, newest_)); }

 private:
  Feed& feed_;
  Decoder decoder_;
  canopen::WallTime newest_ = canopen::wall_now();
  canopen::Subscription subscription_;
};

Feed::Feed(const config::Model& model, std::vector<canopen::Bus*> buses) : model_(model), buses_(std::move(buses)) {}

Feed::~Feed() = default;

void Feed::begin() {
  entries_.resize(kKept);
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    taps_.push_back(std::make_unique<Tap>(*this, *buses_[i], i));
  }
}

void Feed::end() {
  taps_.clear();
  entries_ = {};
  next_ = 0;
}

void Feed::push(const Entry& entry) {
  const std::uint64_t overtaken = oldest();
  if (next_ >= kKept) {
    for (Reader* const reader : readers_) {
      if (reader->next_ == overtaken) {
        reader->lost_ += passes(model_, reader->filter_, at(overtaken)) ? 1U : 0U;
        ++reader->next_;
      }
    }
  }
  at(next_) = entry;
  ++next_;
}

Feed::Reader::Reader(Feed& feed, Filter filter) : feed_(feed), filter_(std::move(filter)), next_(feed.next_) {
  if (feed_.readers_.empty()) {
    feed_.begin();
  }
  feed_.readers_.push_back(this);
}

Feed::Reader::~Reader() {
  feed_.readers_.remove(this);
  if (feed_.readers_.empty()) {
    feed_.end();
  }
}

const Entry* Feed::Reader::next() {
  for (; next_ < feed_.next_; ++next_) {
    if (const Entry& entry = feed_.at(next_); passes(feed_.model_, filter_, entry)) {
      return &entry;
    }
  }
  return nullptr;
}

std::uint64_t Feed::Reader::take_lost() noexcept {
  return std::exchange(lost_, 0);
}

}  // namespace trace
