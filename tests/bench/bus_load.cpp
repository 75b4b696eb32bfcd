#include "tests/bench/bus_load.h"

#include <utility>

namespace bench {

using std::chrono::steady_clock;

BusLoad::BusLoad(SiteInThread& site, unsigned per_second, std::function<canopen::Frame(std::uint64_t)> frame)
    : site_(site), per_second_(per_second), frame_(std::move(frame)), timer_(site.loop()) {
  site_.on_loop([this] {
    link_ = site_.bus().connect();
    begin_ = steady_clock::now();
    step();
  });
}

BusLoad::~BusLoad() {
  site_.on_loop([this] {
    stop_ = true;
    timer_.cancel();
  });
  site_.on_loop([this] { link_.reset(); });
}

std::uint64_t BusLoad::sent() {
  std::uint64_t sent = 0;
  site_.on_loop([&] { sent = sent_; });
  return sent;
}

void BusLoad::step() {
  if (stop_) {
    return;
  }
  const std::chrono::duration<double> since = steady_clock::now() - begin_;
  const auto due = static_cast<std::uint64_t>(since.count() * per_second_);
  for (; sent_ < due; ++sent_) {
    if (link_->send(frame_(sent_)) != canopen::SendResult::handed_over) {
      break;  // the bus is full; the next turn sends it
    }
  }
  timer_.expires_after(std::chrono::milliseconds(1));
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) {
      step();
    }
  });
}

}  // namespace bench
