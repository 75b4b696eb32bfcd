#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "canopen/bus/link.h"

namespace support {

/// A link that remembers what was sent through it.
class RecordingLink final : public canopen::Link {
 public:
  /// `sent` outlives the link.
  RecordingLink(std::unique_ptr<canopen::Link> link, std::vector<canopen::Received>& sent)
      : link_(std::move(link)), sent_(sent) {}
  void open(canopen::LinkEvents& events) override { link_->open(events); }
  void close() override { link_->close(); }
  canopen::SendResult send(const canopen::Frame& frame) override {
    const canopen::SendResult result = link_->send(frame);
    if (result == canopen::SendResult::handed_over) {
      sent_.push_back({frame, canopen::Clock::now(), canopen::wall_now()});
    }
    return result;
  }

 private:
  std::unique_ptr<canopen::Link> link_;
  std::vector<canopen::Received>& sent_;
};

}  // namespace support
