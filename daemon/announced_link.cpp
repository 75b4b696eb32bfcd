#include "daemon/announced_link.h"

#include <optional>
#include <ostream>
#include <utility>

namespace gateway {
namespace {

class AnnouncedLink final : public canopen::Link, private canopen::LinkEvents {
 public:
  AnnouncedLink(std::unique_ptr<canopen::Link> link, std::string name, std::ostream& out)
      : link_(std::move(link)), name_(std::move(name)), out_(out) {}

  void open(canopen::LinkEvents& events) override {
    events_ = &events;
    link_->open(*this);
  }
  void close() override { link_->close(); }
  [[nodiscard]] canopen::SendResult send(const canopen::Frame& frame) override { return link_->send(frame); }
  [[nodiscard]] canopen::TimePoint heard_until() override { return link_->heard_until(); }
  [[nodiscard]] bool echoes_prove_departure() const noexcept override { return link_->echoes_prove_departure(); }

 private:
  void on_frames(std::span<const canopen::Received> frames) override { events_->on_frames(frames); }
  void on_echo(const canopen::Received& sent) override { events_->on_echo(sent); }
  void on_bus_state(const canopen::BusState& state) override {
    if (std::exchange(told_, state.condition) != state.condition) {
      out_ << name_ << ": " << canopen::describe(state.condition) << std::endl;
    }
    events_->on_bus_state(state);
  }
  void on_frames_lost(std::uint32_t count) override { events_->on_frames_lost(count); }
  void on_error_frame(const canopen::Received& error, canopen::ErrorSign sign) override {
    events_->on_error_frame(error, sign);
  }
  void on_bit_timing(const canopen::BitTiming& timing) override { events_->on_bit_timing(timing); }

  std::unique_ptr<canopen::Link> link_;
  std::string name_;
  std::ostream& out_;
  canopen::LinkEvents* events_ = nullptr;  ///< Nothing comes before open() or after close().
  std::optional<canopen::BusCondition> told_;
};

}  // namespace

std::unique_ptr<canopen::Link> make_announced_link(std::unique_ptr<canopen::Link> link, std::string name,
                                                   std::ostream& out) {
  return std::make_unique<AnnouncedLink>(std::move(link), std::move(name), out);
}

}  // namespace gateway
