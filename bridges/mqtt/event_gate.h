#pragma once

#include <future>
#include <memory>
#include <mutex>
#include <string>

#include "bridges/mqtt/client.h"

namespace mqtt {

/// Passes a client's events on until it is closed, so that the client can be left behind.
class EventGate final : public ClientEvents {
 public:
  /// `events` outlives the gate, or close().
  explicit EventGate(ClientEvents& events) : events_(&events) {}
  /// None passes from now on. The caller holds no lock that the events take.
  void close();

  void on_up(BrokerLimits limits) noexcept override;
  void on_refused(Refusal refusal) noexcept override;
  void on_down(int code) noexcept override;
  void on_incoming(Incoming&& message) noexcept override;
  void on_sent(const Message* message, Delivery delivery, int code) noexcept override;
  void on_subscribed(Subscribed&& subscribed) noexcept override;
  void on_unsubscribed(const std::string& filter) noexcept override;

 private:
  std::mutex mutex_;
  ClientEvents* events_;  ///< Null: closed.
};

/// Closes the gate and destroys the client, in a thread of its own: Paho waits there for its lock, which it holds while
/// it looks up the name of a broker with TLS. Ready when that is done; nobody has to wait for it.
[[nodiscard]] std::future<void> let_go(std::unique_ptr<Client> client, std::unique_ptr<EventGate> gate);

}  // namespace mqtt
