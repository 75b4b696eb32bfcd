#pragma once

#include <memory>
#include <utility>

#include "canopen/bus/link.h"

namespace support {

/// A link that takes no frame while it is closed, as on a bus where others always win; it receives all the while.
class GatedLink final : public canopen::Link {
 public:
  /// `closed` outlives the link.
  GatedLink(std::unique_ptr<canopen::Link> link, const bool& closed) : link_(std::move(link)), closed_(closed) {}
  void open(canopen::LinkEvents& events) override { link_->open(events); }
  void close() override { link_->close(); }
  canopen::SendResult send(const canopen::Frame& frame) override {
    return closed_ ? canopen::SendResult::busy : link_->send(frame);
  }

 private:
  std::unique_ptr<canopen::Link> link_;
  const bool& closed_;
};

}  // namespace support
