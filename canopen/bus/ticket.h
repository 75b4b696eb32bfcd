#pragma once

#include <cstdint>
#include <functional>

namespace canopen {

class TransmitQueue;
enum class Departure : std::uint8_t;

/// A frame of ours on its way, owned by the procedure that wants it sent: when the ticket goes, a frame that still
/// waits is withdrawn and nobody is told. So nothing of a procedure that has ended leaves later. What the kernel has
/// can not be withdrawn. Must go before the bus.
class [[nodiscard]] Ticket {
 public:
  using Told = std::function<void(Departure)>;

  Ticket() = default;
  ~Ticket() { reset(); }
  Ticket(const Ticket&) = delete;
  Ticket& operator=(const Ticket&) = delete;
  Ticket(Ticket&& other) noexcept;
  /// The frame of before is withdrawn.
  Ticket& operator=(Ticket&& other) noexcept;

  /// A frame was queued, and the ticket was not given up since.
  explicit operator bool() const noexcept { return queue_ != nullptr; }
  void reset();
  /// The kernel does not have it yet.
  [[nodiscard]] bool waiting() const;
  /// Withdraws the frame where it still waits, and tells so.
  void withdraw();

 private:
  friend class TransmitQueue;
  Ticket(TransmitQueue& queue, std::uint64_t id) : queue_(&queue), id_(id) {}

  TransmitQueue* queue_ = nullptr;
  std::uint64_t id_ = 0;
};

}  // namespace canopen
