#pragma once

#include "canopen/node/remote_node.h"

namespace canopen {

/// Counts what is done for a caller, so that stop() can wait for its end.
class RemoteNode::Operation {
 public:
  explicit Operation(RemoteNode& owner) : owner_(owner) { ++owner_.operations_; }
  ~Operation() {
    --owner_.operations_;
    owner_.ended_.notify();
  }
  Operation(const Operation&) = delete;
  Operation& operator=(const Operation&) = delete;

 private:
  RemoteNode& owner_;
};

}  // namespace canopen
