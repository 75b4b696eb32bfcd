#include "bridges/mqtt/requests.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <exception>
#include <utility>
#include <variant>

#include "bridges/mqtt/under_way.h"
#include "bridges/process/command_checks.h"
#include "bridges/process/stop_all.h"

namespace mqtt {

using canopen::Error;
using canopen::ErrorKind;
using canopen::Result;

namespace {

process::Origin origin_of(const Incoming& incoming, std::string id) {
  process::Origin origin{.writer = mqtt_writer(), .id = std::move(id), .received = incoming.received};
  if (incoming.expiry) {
    origin.expires = incoming.received + std::chrono::seconds(*incoming.expiry);
  }
  return origin;
}

// Expired already when it came, or while it waited for the loop (MQTT 5 §3.3.2.3.3).
bool is_expired(const Incoming& incoming, canopen::TimePoint now) {
  return incoming.expiry && now - incoming.received >= std::chrono::seconds(*incoming.expiry);
}

process::CommandRecord::Kind kind_of(const Route& route) {
  using Kind = process::CommandRecord::Kind;
  if (route.kind == Route::Kind::nmt) {
    return Kind::nmt;
  }
  return route.kind == Route::Kind::sdo ? Kind::raw : Kind::write;
}

}  // namespace

process::Writer mqtt_writer() {
  return {.way = process::Writer::Way::mqtt, .address = {}};
}

Requests::Requests(boost::asio::any_io_executor executor, process::Plant& plant, const Topics& topics, Publish publish)
    : executor_(std::move(executor)),
      plant_(plant),
      topics_(topics),
      stop_signs_(plant.shared_model(), topics),
      under_way_(std::make_shared<UnderWay>(executor_, plant, std::move(publish))) {}

void Requests::change(const process::PlantChange& change) {
  stop_signs_.change(plant_.shared_model());
  under_way_->change(plant_, change);
}

void Requests::handle(const Incoming& incoming, const Route& route) {
  take(incoming, route, std::nullopt);
}

void Requests::come_too_late(const Incoming& incoming) {
  const auto route = topics_.route(incoming.topic);
  if (route && (route->kind == Route::Kind::alive || carries_command(*route))) {
    take(incoming, *route,
         Error{.kind = ErrorKind::offline,
               .detail = "the gateway is on its way to another broker; nothing was sent, give the command there"});
  }
}

void Requests::take(const Incoming& incoming, const Route& route, const std::optional<Error>& refusal) {
  if (!under_way_->open) {
    return;
  }
  if (route.kind == Route::Kind::alive) {
    take_sign_of_life(incoming, route);
    return;
  }
  // An empty payload is what empties a retained topic, by us or by somebody else.
  if (incoming.payload.empty()) {
    return;
  }
  Command command = take_apart(incoming, route);
  if (incoming.retained) {
    under_way_->send({.topic = incoming.topic, .payload = {}});
  }
  if (const auto refused = refuse_sender(incoming, command)) {
    under_way_->send(command_answer(command.to, refuse(incoming, command, *refused)));
    return;
  }
  const canopen::TimePoint now = canopen::Clock::now();
  command.expired = is_expired(incoming, now);
  Asker asker{.to = command.to};
  if (command.allowed && may_repeat(incoming, command)) {
    const auto earlier = under_way_->duplicates.earlier(incoming, command.has_id, now);
    if (earlier && !command.expired) {
      (void)refuse(incoming, command, duplicate_error());  // its answer waits for the first
      under_way_->repeat(command.to, *earlier);
      return;
    }
    asker.ticket = earlier ? Duplicates::kNone : under_way_->duplicates.remember(incoming, now);
  }
  const Result<void> begun = refusal && !command.stops ? Result<void>(*refusal) : begin(incoming, command, asker);
  if (begun.has_error()) {
    under_way_->settle(asker, refuse(incoming, command, begun.error()));
  }
}

process::Outcome Requests::refuse(const Incoming& incoming, const Command& command, Error mistake) {
  if (command.asked.has_value() && std::holds_alternative<StopAll>(command.asked.value())) {
    process::refuse_stop_all(plant_, origin_of(incoming, command.id), mistake);
  }
  const bool is_command = command.drive != nullptr && !command.reads;
  return is_command ? command.drive->refuse(origin_of(incoming, command.id), command.kind, std::move(mistake))
                    : process::Outcome(std::move(mistake));
}

// A mistake in it is told each time.
bool Requests::may_repeat(const Incoming& incoming, const Command& command) {
  return !command.reads && !command.stops && incoming.payload.size() <= kMaxCommand &&
         (command.asked.has_value() || !may_come_again(command.asked.error()));
}

bool Requests::is_idle() const noexcept {
  return under_way_->total == under_way_->reads;
}

boost::asio::awaitable<void> Requests::stop(canopen::Duration patience) {
  const std::shared_ptr<UnderWay> under_way = under_way_;
  under_way->open = false;
  if (under_way->total != 0) {
    under_way->idle.expires_after(patience);
    boost::system::error_code ignored;
    co_await under_way->idle.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, ignored));
  }
  under_way->publish = nullptr;
}

Requests::Command Requests::take_apart(const Incoming& incoming, const Route& route) const {
  const Parsed parsed = parse_command(route, incoming.payload);
  process::Drive* drive = plant_.find(route.drive);
  Command command{.to = reply_to(incoming, route, drive),
                  .drive = drive,
                  .has_id = !parsed.id.empty(),
                  .id = parsed.id_text,
                  .kind = kind_of(route),
                  .reads = asks_to_read(route, parsed),
                  .asked = asked_of(drive == nullptr ? nullptr : &drive->model(), route, parsed)};
  command.to.id = parsed.id;
  command.allowed = drive == nullptr || command.reads || !process::refuse_writer(drive->model(), mqtt_writer());
  if (command.asked.has_value()) {
    const Asked& asked = command.asked.value();
    command.stops = drive == nullptr ? std::holds_alternative<StopAll>(asked) : stops(drive->model(), asked);
    const auto* fields = std::get_if<Fields>(&asked);
    if (fields != nullptr && fields->mistake && !command.stops) {
      command.asked = Error(*fields->mistake);
    }
  }
  return command;
}

ReplyTo Requests::reply_to(const Incoming& incoming, const Route& route, const process::Drive* drive) const {
  ReplyTo to{.topic = topics_.result(),
             .correlation = incoming.correlation,
             .command_topic = incoming.topic,
             .sdo = route.kind == Route::Kind::sdo};
  if (!incoming.response_topic.empty() && !topics_.refused_as_response(incoming.response_topic)) {
    to.topic = incoming.response_topic;
  } else if (to.sdo && drive != nullptr) {
    to.topic = topics_.drive(drive->index()).sdo_response;
  }
  return to;
}

std::optional<Error> Requests::refuse_sender(const Incoming& incoming, const Command& command) const {
  if (incoming.retained) {
    return Error{.kind = ErrorKind::retained,
                 .detail = "a retained command is never carried out; its topic was emptied"};
  }
  if (!command.allowed) {
    // One without a mistake is refused by its drive, so that it stands in the journal.
    return command.asked.has_error() ? process::refuse_writer(command.drive->model(), mqtt_writer()) : std::nullopt;
  }
  // A stop is not lost for the sake of its answer.
  if (!command.stops && !incoming.response_topic.empty() && command.to.topic != incoming.response_topic) {
    return Error{
        .kind = ErrorKind::forbidden,
        .detail =
            "no answer goes to this response topic; name one outside of the gateways' topics and inside of `answers`"};
  }
  return std::nullopt;
}

Result<void> Requests::begin(const Incoming& incoming, Command& command, const Asker& asker) {
  // Of others their drive says so, and they stand in the journal. SDO requests may have mistakes that it looks at
  // first.
  if (command.expired && (command.asked.has_error() || command.drive == nullptr || command.to.sdo)) {
    return Error{.kind = ErrorKind::expired, .detail = "the command came after its message expiry interval"};
  }
  if (command.asked.has_error()) {
    return command.asked.error();
  }
  std::shared_ptr<DriveLoad> load;
  if (command.drive != nullptr) {
    load = under_way_->loads.at(command.drive->index());
    const bool waits = command.allowed && !command.expired && !command.stops;
    if (waits && (command.reads ? load->reads >= kMaxReads : load->commands >= kMaxCommands)) {
      under_way_->duplicates.forget(asker.ticket);  // it may come again with the same id
      return Error{.kind = ErrorKind::timeout,
                   .detail = std::string("too many ") + (command.reads ? "reads" : "commands") +
                             " under way; this one was not carried out"};
    }
  }
  under_way_->begins(load.get(), command.reads);
  boost::asio::co_spawn(
      executor_,
      carry_out(under_way_, plant_, load, origin_of(incoming, command.id), std::move(command.asked.value()), asker),
      [under_way = under_way_, load, reads = command.reads](std::exception_ptr failure) {
        under_way->ended(load.get(), reads);
        if (failure) {
          std::rethrow_exception(failure);
        }
      });
  return {};
}

// A message that the broker kept may be of any time. It moves nothing, so it needs no answer.
void Requests::take_sign_of_life(const Incoming& incoming, const Route& route) {
  process::Drive* drive = plant_.find(route.drive);
  if (incoming.retained) {
    if (!incoming.payload.empty()) {
      under_way_->send({.topic = incoming.topic, .payload = {}});
    }
  } else if (drive != nullptr && !process::refuse_writer(drive->model(), mqtt_writer())) {
    drive->sign_of_life(mqtt_writer());
  }
}

}  // namespace mqtt
