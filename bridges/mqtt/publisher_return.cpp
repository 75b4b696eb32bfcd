// The way back to the first broker: it is looked for from the one in use, and tried before that is left.

#include <utility>

#include "bridges/mqtt/password.h"
#include "bridges/mqtt/publisher.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;

constexpr auto kLookPatience = 3s;
// As long as a connection has where there is no hurry.
constexpr auto kTrialPatience = 7s;

}  // namespace

void Publisher::look_home(Clock::time_point now) {
  if (rotation_.at() == 0 || line_.leave_by) {
    return;
  }
  if (const std::optional<Reach> reach = look_.take()) {
    if (look_tries_) {
      homecoming_.tried(reach->good, now);
    } else {
      homecoming_.looked(reach->good, now);
    }
    tell_may_leave(homecoming_.may_go());
    if (look_tries_ && !reach->good) {
      say(Level::warning, "MQTT: " + candidates_.front().name + " answers again, but takes no connection of ours: " +
                              reach->why + "; " + candidate().name + " stays in use, and this is tried again later");
    }
  } else if (const Homecoming::Step step = homecoming_.due(now); !look_.runs() && step != Homecoming::Step::none) {
    begin_look(step);
  }
}

void Publisher::tell_may_leave(bool may) {
  if (may != line_.asked_to_leave) {
    line_.asked_to_leave = may;
    loop_->post([this, may, connection = line_.connection] { events_->on_may_leave(connection, may); });
  }
}

void Publisher::begin_look(Homecoming::Step step) {
  const config::Endpoint& first = settings_.brokers.front();
  look_tries_ = step == Homecoming::Step::try_it;
  if (!look_tries_) {
    (void)look_.start([resolver = settings_.resolver, first, tls = settings_.client.tls] {
      return reaches(first, resolver(first), tls, kLookPatience);
    });
    return;
  }
  (void)look_.start([resolver = settings_.resolver, first, client = settings_.client, version = settings_.version,
                     file = settings_.password_file]() mutable {
    if (std::string mistake = read_password(file, client.password); !mistake.empty()) {
      return Reach{.why = std::move(mistake)};
    }
    return takes_us(first, resolver(first), client, version, kTrialPatience);
  });
}

}  // namespace mqtt
