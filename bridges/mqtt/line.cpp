#include "bridges/mqtt/line.h"

#include <algorithm>
#include <utility>

#include "bridges/mqtt/reasons.h"
#include "bridges/mqtt/topics.h"

namespace mqtt {

std::string text_of(const Refusal& refusal) {
  if (!refusal.why.empty()) {
    return refusal.why;
  }
  if (refusal.code >= 0) {
    return "the broker refuses the connection: " + reason_text(refusal.code);
  }
  if (refusal.nobody) {
    return "the connection is refused";
  }
  return refusal.closed ? "the connection is closed before the broker answers" : "no connection";
}

void Line::begin() {
  *this = {.connection = connection + 1, .state = State::connecting};
}

void Line::up(const BrokerLimits& of_broker) {
  if (state == State::connecting) {
    state = State::up;
    limits = of_broker;
  }
}

void Line::refused(const Refusal& by_broker) {
  if (state == State::connecting) {
    state = State::refused;
    refusal = by_broker;
  }
}

void Line::down(int code) {
  state = state == State::connecting ? State::refused : State::down;
  down_code = code >= 0 ? code : down_code;
}

std::vector<Line::Order> Line::take_orders() {
  for (const Order& order : orders) {
    std::erase(watched, order.subscription.filter);  // one that was refused is asked for again and again
    if (order.subscription.watched || order.subscription.bulk) {
      watched.push_back(order.subscription.filter);
    }
  }
  return std::exchange(orders, {});
}

bool Line::is_watched(std::string_view topic) const {
  return std::any_of(watched.begin(), watched.end(),
                     [topic](const std::string& filter) { return matches(filter, topic); });
}

Line::End Line::end(const std::string& client_id) const {
  if (leave_by) {
    return {.why = "left, for the first broker can be reached again", .left = true};
  }
  if (stalled) {
    return {.why = "the broker acknowledges nothing any more", .silent = true};
  }
  if (down_code < 0) {
    return {.why = drop.value_or("the connection broke"),
            .stays = suspects_takeover,
            .unexplained = state == State::down && !drop,
            .dropped = drop.has_value()};
  }
  std::string why = "the broker ended the connection: " + reason_text(down_code);
  if (is_takeover(down_code)) {
    why += ": another client has the client id " + client_id;
  }
  return {std::move(why), is_takeover(down_code), !spares_messages(down_code)};
}

}  // namespace mqtt
