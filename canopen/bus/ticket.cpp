#include "canopen/bus/ticket.h"

#include <utility>

#include "canopen/bus/transmit_queue.h"

namespace canopen {

Ticket::Ticket(Ticket&& other) noexcept : queue_(std::exchange(other.queue_, nullptr)), id_(other.id_) {}

Ticket& Ticket::operator=(Ticket&& other) noexcept {
  if (this != &other) {
    reset();
    queue_ = std::exchange(other.queue_, nullptr);
    id_ = other.id_;
  }
  return *this;
}

void Ticket::reset() {
  if (TransmitQueue* const queue = std::exchange(queue_, nullptr)) {
    queue->drop(id_);
  }
}

bool Ticket::waiting() const {
  return queue_ != nullptr && queue_->waits(id_);
}

void Ticket::withdraw() {
  if (queue_ != nullptr) {
    queue_->withdraw(id_);
  }
}

}  // namespace canopen
