#include "bridges/mqtt/requests.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <exception>
#include <utility>
#include <vector>

#include "bridges/mqtt/under_way.h"
#include "bridges/process/command_checks.h"

namespace mqtt {

using canopen::Error;
using canopen::ErrorKind;
using canopen::Result;

namespace {

process::Writer mqtt_writer() {
  return {.way = process::Writer::Way::mqtt, .address = {}};
}

process::Origin origin_of(const Incoming& incoming) {
  process::Origin origin{.writer = mqtt_writer(), .received = incoming.received};
  if (incoming.expiry) {
    origin.expires = incoming.received + std::chrono::seconds(*incoming.expiry);
  }
  return origin;
}

bool is_sdo(const Route& route) {
  return route.kind == Route::Kind::sdo;
}

// Expired already when it came, or while it waited for the loop (MQTT 5 §3.3.2.3.3).
bool is_expired(const Incoming& incoming, canopen::TimePoint now) {
  return incoming.expiry && now - incoming.received >= std::chrono::seconds(*incoming.expiry);
}

Message refusal(const Route& route, const ReplyTo& to, const Error& error) {
  return is_sdo(route) ? sdo_answer(to, error, canopen::DataType::u8) : command_answer(to, error);
}

}  // namespace

Requests::Requests(boost::asio::any_io_executor executor, process::Plant& plant, const Topics& topics, Publish publish)
    : executor_(std::move(executor)),
      plant_(plant),
      topics_(topics),
      under_way_(std::make_shared<UnderWay>(executor_, plant.size(), std::move(publish))) {}

void Requests::handle(const Incoming& incoming) {
  const auto route = topics_.route(incoming.topic);
  if (!under_way_->open || !route || route->kind == Route::Kind::alarm) {
    return;
  }
  if (route->kind == Route::Kind::alive) {
    take_sign_of_life(incoming, *route);
    return;
  }
  // An empty payload is what empties a retained topic, by us or by somebody else.
  if (incoming.payload.empty()) {
    return;
  }
  const Command command = take_apart(incoming, *route);
  Result<void> begun = check(incoming, command);
  if (incoming.retained) {
    under_way_->send({.topic = incoming.topic, .payload = {}});
  }
  if (begun.has_value()) {
    begun = begin(incoming, command);
  }
  if (begun.has_error()) {
    under_way_->send(refusal(*route, command.to, begun.error()));
  }
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

Requests::Command Requests::take_apart(const Incoming& incoming, const Route& route) {
  const bool value =
      route.kind == Route::Kind::set_signal || route.kind == Route::Kind::nmt || route.kind == Route::Kind::stop_all;
  Parsed parsed = value ? parse_value(incoming.payload) : parse_object_payload(incoming.payload);
  process::Drive* drive = find_drive(route.drive);
  ReplyTo to{
      .topic = topics_.result(), .correlation = incoming.correlation, .command_topic = incoming.topic, .id = parsed.id};
  if (!incoming.response_topic.empty() && !topics_.refused_as_response(incoming.response_topic)) {
    to.topic = incoming.response_topic;
  } else if (is_sdo(route) && drive != nullptr) {
    to.topic = topics_.drive(drive->index()).sdo_response;
  }
  return {route, std::move(parsed), std::move(to), drive};
}

Result<void> Requests::check(const Incoming& incoming, const Command& command) const {
  if (incoming.retained) {
    return Error{.kind = ErrorKind::retained,
                 .detail = "a retained command is never carried out; its topic was emptied"};
  }
  const bool stops_all = command.route.kind == Route::Kind::stop_all;
  // A stop for all is not lost for the sake of its answer.
  if (!stops_all && !incoming.response_topic.empty() && command.to.topic != incoming.response_topic) {
    return Error{.kind = ErrorKind::forbidden,
                 .detail = "the response topic belongs to the gateways; name one outside of their topics"};
  }
  if (is_expired(incoming, canopen::Clock::now())) {
    return Error{.kind = ErrorKind::expired, .detail = "the command came after its message expiry interval"};
  }
  if (!stops_all && command.drive == nullptr) {
    return Error{.kind = ErrorKind::unknown, .detail = "no drive \"" + std::string(command.route.drive) + "\""};
  }
  return {};
}

Result<void> Requests::begin(const Incoming& incoming, const Command& command) {
  if (command.route.kind == Route::Kind::stop_all) {
    return begin_stop_all(incoming, command);
  }
  const bool set_signal = command.route.kind == Route::Kind::set_signal;
  if (set_signal && !command.drive->model().find(command.route.signal)) {
    return Error{
        .kind = ErrorKind::unknown,
        .detail = command.drive->model().name + " has no signal \"" + std::string(command.route.signal) + "\""};
  }
  if (command.parsed.members.has_error()) {
    return command.parsed.members.error();
  }
  switch (command.route.kind) {
    case Route::Kind::nmt:
      return begin_nmt(incoming, command);
    case Route::Kind::sdo:
      return begin_sdo(incoming, command);
    case Route::Kind::set_signal:
    case Route::Kind::set_drive:
    case Route::Kind::alive:
    case Route::Kind::stop_all:
    case Route::Kind::alarm:
      break;
  }
  return begin_set(incoming, command);
}

Result<void> Requests::begin_stop_all(const Incoming& incoming, const Command& command) {
  spawn(nullptr, stop_every_drive(under_way_, plant_, origin_of(incoming), command.to));
  return {};
}

// A message that the broker kept may be of any time. It moves nothing, so it needs no answer.
void Requests::take_sign_of_life(const Incoming& incoming, const Route& route) {
  process::Drive* drive = find_drive(route.drive);
  if (incoming.retained) {
    if (!incoming.payload.empty()) {
      under_way_->send({.topic = incoming.topic, .payload = {}});
    }
  } else if (drive != nullptr && !process::refuse_writer(drive->model(), mqtt_writer())) {
    drive->sign_of_life(mqtt_writer());
  }
}

Result<void> Requests::check_begin(const Incoming& incoming, const Command& command,
                                   std::span<const process::FieldWrite> fields) {
  if (command.drive->is_stop(fields)) {
    return {};
  }
  // Before the command is noted as seen: it may come again with the same id.
  if (under_way_->commands.at(command.drive->index()) >= kMaxCommands) {
    return Error{.kind = ErrorKind::timeout, .detail = "too many commands under way; this one was not carried out"};
  }
  if (duplicates_.seen(incoming, !command.parsed.id.empty(), canopen::Clock::now())) {
    return Error{.kind = ErrorKind::duplicate, .detail = "the same command came within the last 60 s"};
  }
  return {};
}

Result<void> Requests::begin_set(const Incoming& incoming, const Command& command) {
  const config::Drive& model = command.drive->model();
  const FlatObject& members = command.parsed.members.value();
  // `<signal>/set` carries one member, `value`.
  Result<std::vector<process::FieldWrite>> fields =
      command.route.kind == Route::Kind::set_drive
          ? fields_of(model, members)
          : fields_of(model, {{std::string(command.route.signal), members.front().second}});
  if (fields.has_error()) {
    return fields.error();
  }
  Result<void> checked = check_begin(incoming, command, fields.value());
  if (checked.has_value()) {
    spawn(&under_way_->commands.at(command.drive->index()),
          write_fields(under_way_, *command.drive, origin_of(incoming), std::move(fields.value()), command.to));
  }
  return checked;
}

Result<void> Requests::begin_nmt(const Incoming& incoming, const Command& command) {
  const Result<canopen::NmtCommand> nmt = nmt_command_of(command.parsed.members.value());
  if (nmt.has_error()) {
    return nmt.error();
  }
  Result<void> checked = check_begin(incoming, command);
  if (checked.has_value()) {
    spawn(&under_way_->commands.at(command.drive->index()),
          send_nmt(under_way_, *command.drive, origin_of(incoming), nmt.value(), command.to));
  }
  return checked;
}

Result<void> Requests::begin_sdo(const Incoming& incoming, const Command& command) {
  const Result<SdoRequest> request = sdo_request_of(command.parsed.members.value());
  if (request.has_error()) {
    return request.error();
  }
  if (!request.value().value) {  // a read changes nothing and is never a repetition
    std::size_t& reads = under_way_->reads.at(command.drive->index());
    if (reads >= kMaxReads) {
      return Error{.kind = ErrorKind::timeout, .detail = "too many reads under way; this one was not carried out"};
    }
    spawn(&reads, read_object(under_way_, *command.drive, request.value(), command.to));
    return {};
  }
  std::vector<process::FieldWrite> fields;
  if (const auto signal = process::writable_signal(command.drive->model(), request.value().object)) {
    fields.push_back({*signal, *request.value().value});
  }
  Result<void> checked = check_begin(incoming, command, fields);
  if (checked.has_value()) {
    spawn(&under_way_->commands.at(command.drive->index()),
          write_object(under_way_, *command.drive, origin_of(incoming), request.value(), command.to));
  }
  return checked;
}

void Requests::spawn(std::size_t* among, boost::asio::awaitable<void> work) {
  if (among != nullptr) {
    ++*among;
  }
  ++under_way_->total;
  boost::asio::co_spawn(executor_, std::move(work), [under_way = under_way_, among](std::exception_ptr failure) {
    under_way->ended(among);
    if (failure) {
      std::rethrow_exception(failure);
    }
  });
}

process::Drive* Requests::find_drive(std::string_view name) {
  for (std::size_t i = 0; i < plant_.size(); ++i) {
    if (plant_.drive(i).model().name == name) {
      return &plant_.drive(i);
    }
  }
  return nullptr;
}

}  // namespace mqtt
