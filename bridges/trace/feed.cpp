#include "bridges/trace/feed.h"

#include <algorithm>
#include <utility>

namespace trace {

/// The frames of one bus.
class Feed::Tap final : public canopen::FrameTap {
 public:
  Tap(Feed& feed, canopen::Bus& bus, std::size_t index)
      : feed_(feed), decoder_(*feed.model_, index), subscription_(bus.add_tap(*this)) {}

  void on_frame(const canopen::Received& received, canopen::FrameOrigin origin) override {
    newest_ = received.wall;
    feed_.push(decoder_.decode(received.frame, received.wall, origin));
  }
  void place(std::size_t index) { decoder_.place(*feed_.model_, index); }
  void on_frames_lost(std::uint32_t count) override { feed_.push(decoder_.lose(count, newest_)); }

 private:
  Feed& feed_;
  Decoder decoder_;
  canopen::WallTime newest_ = canopen::wall_now();
  canopen::Subscription subscription_;
};

Feed::Feed(const config::Model& model, std::vector<canopen::Bus*> buses) : model_(&model), buses_(std::move(buses)) {}

// Where the program is unwound, the readers' coroutines go with the loop, which is after us.
Feed::~Feed() {
  for (Reader* const reader : readers_) {
    reader->feed_ = nullptr;
  }
}

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

void Feed::change(const config::Model& model, std::vector<canopen::Bus*> buses, const config::Positions& from_drives,
                  const config::Positions& from_buses) {
  const config::Model& before = *std::exchange(model_, &model);
  std::vector<std::unique_ptr<Tap>> taps;
  for (std::size_t i = 0; !readers_.empty() && i < buses.size(); ++i) {
    if (from_buses[i]) {
      taps.push_back(std::move(taps_[*from_buses[i]]));
      taps.back()->place(i);
    } else {
      taps.push_back(std::make_unique<Tap>(*this, *buses[i], i));
    }
  }
  taps_ = std::move(taps);
  buses_ = std::move(buses);
  const auto position = [](const config::Positions& from, std::optional<std::uint16_t> was) {
    const auto found = std::ranges::find(from, was ? std::optional<std::size_t>(*was) : std::nullopt);
    return !was || found == from.end() ? std::nullopt : std::optional(static_cast<std::uint16_t>(found - from.begin()));
  };
  for (Entry& entry : entries_) {
    entry.drive = position(from_drives, entry.drive);
    entry.mapping = entry.drive ? entry.mapping : std::nullopt;
    entry.bus = position(from_buses, entry.bus);
    entry.gone = !entry.bus;
  }
  for (Reader* const reader : readers_) {
    reader->filter_ = moved(std::move(reader->filter_), before, model);
    reader->model_ = &model;
  }
}

void Feed::push(const Entry& entry) {
  at(next_) = entry;
  ++next_;
}

Feed::Reader::Reader(Feed& feed, Filter filter)
    : feed_(&feed), model_(feed.model_), filter_(std::move(filter)), next_(feed.next_) {
  if (feed.readers_.empty()) {
    feed.begin();
  }
  feed.readers_.push_back(this);
}

Feed::Reader::~Reader() {
  if (feed_ == nullptr) {
    return;
  }
  feed_->readers_.remove(this);
  if (feed_->readers_.empty()) {
    feed_->end();
  }
}

void Feed::Reader::catch_up() noexcept {
  if (feed_ != nullptr && next_ < feed_->oldest()) {
    lost_ += feed_->oldest() - next_;
    next_ = feed_->oldest();
  }
}

const Entry* Feed::Reader::next() noexcept {
  return feed_ != nullptr && next_ < feed_->next_ ? &feed_->at(next_) : nullptr;
}

std::uint64_t Feed::Reader::take_lost() noexcept {
  catch_up();
  return std::exchange(lost_, 0);
}

}  // namespace trace
