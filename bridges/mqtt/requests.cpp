#include "bridges/mqtt/requests.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <exception>
#include <utility>
#include <vector>

namespace mqtt {

using canopen::Error;
using canopen::ErrorKind;
using canopen::Result;

// Shared with the commands under way, which may outlive the requests by the time a drive takes to stop.
struct UnderWay {
  UnderWay(const boost::asio::any_io_executor& executor, std::size_t drives, Requests::Publish to_publish)
      : publish(std::move(to_publish)), commands(drives), reads(drives), idle(executor) {}

  void send(Message message) const {
    if (publish) {
      publish(std::move(message));
    }
  }
  void ended(std::size_t drive, bool is_read) {
    --(is_read ? reads : commands).at(drive);
    --total;
    if (total == 0) {
      idle.cancel();
    }
  }

  Requests::Publish publish;  ///< Empty after stop().
  bool open = true;
  std::vector<std::size_t> commands;  ///< By drive.
  std::vector<std::size_t> reads;     ///< Likewise; apart, for a stop must not fail because of them.
  std::size_t total = 0;
  canopen::Timer idle;  ///< Cancelled when the last one ended.
};

namespace {

process::Origin origin_of(const Incoming& incoming) {
  process::Origin origin{.writer = {.way = process::Writer::Way::mqtt, .address = {}}, .received = incoming.received};
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

// Free functions, their parameters by value: what a coroutine refers to lives in its frame, or longer than it.
boost::asio::awaitable<void> write_fields(std::shared_ptr<UnderWay> under_way, process::Drive& drive,
                                          process::Origin origin, std::vector<process::FieldWrite> fields, ReplyTo to) {
  const process::Outcome outcome = co_await drive.write(std::move(origin), std::move(fields));
  under_way->send(command_answer(to, outcome));
}

boost::asio::awaitable<void> send_nmt(std::shared_ptr<UnderWay> under_way, process::Drive& drive,
                                      process::Origin origin, canopen::NmtCommand nmt, ReplyTo to) {
  const process::Outcome outcome = co_await drive.nmt(std::move(origin), nmt);
  under_way->send(command_answer(to, outcome));
}

boost::asio::awaitable<void> read_object(std::shared_ptr<UnderWay> under_way, process::Drive& drive, SdoRequest request,
                                         ReplyTo to) {
  const Result<canopen::Raw> read = co_await drive.sdo_read(request.object, request.type);
  if (read.has_error()) {
    under_way->send(sdo_answer(to, read.error(), request.type));
  } else {
    under_way->send(sdo_answer(to, std::optional<canopen::Raw>(read.value()), request.type));
  }
}

boost::asio::awaitable<void> write_object(std::shared_ptr<UnderWay> under_way, process::Drive& drive,
                                          process::Origin origin, SdoRequest request, ReplyTo to) {
  const canopen::ObjectValue value{request.object, request.type, *request.value};
  const process::Outcome written = co_await drive.sdo_write(std::move(origin), value);
  if (written.has_error()) {
    under_way->send(sdo_answer(to, written.error(), request.type));
  } else {
    under_way->send(sdo_answer(to, std::optional<canopen::Raw>(), request.type));
  }
}

}  // namespace

Requests::Requests(boost::asio::any_io_executor executor, process::Plant& plant, const Topics& topics, Publish publish)
    : executor_(std::move(executor)),
      plant_(plant),
      topics_(topics),
      under_way_(std::make_shared<UnderWay>(executor_, plant.size(), std::move(publish))) {}

void Requests::handle(const Incoming& incoming) {
  const auto route = topics_.route(incoming.topic);
  // An empty payload is what empties a retained topic, by us or by somebody else.
  if (!under_way_->open || incoming.payload.empty() || !route || route->kind == Route::Kind::alarm) {
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
  const bool value = route.kind == Route::Kind::set_signal || route.kind == Route::Kind::nmt;
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
  if (!incoming.response_topic.empty() && command.to.topic != incoming.response_topic) {
    return Error{.kind = ErrorKind::forbidden,
                 .detail = "the response topic belongs to the gateways; name one outside of their topics"};
  }
  if (is_expired(incoming, canopen::Clock::now())) {
    return Error{.kind = ErrorKind::expired, .detail = "the command came after its message expiry interval"};
  }
  if (command.drive == nullptr) {
    return Error{.kind = ErrorKind::unknown, .detail = "no drive \"" + std::string(command.route.drive) + "\""};
  }
  return {};
}

Result<void> Requests::begin(const Incoming& incoming, const Command& command) {
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
    case Route::Kind::alarm:
      break;
  }
  return begin_set(incoming, command);
}

Result<void> Requests::check_begin(const Incoming& incoming, const Command& command) {
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
  Result<void> checked = check_begin(incoming, command);
  if (checked.has_value()) {
    spawn(*command.drive,
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
    spawn(*command.drive, send_nmt(under_way_, *command.drive, origin_of(incoming), nmt.value(), command.to));
  }
  return checked;
}

Result<void> Requests::begin_sdo(const Incoming& incoming, const Command& command) {
  const Result<SdoRequest> request = sdo_request_of(command.parsed.members.value());
  if (request.has_error()) {
    return request.error();
  }
  if (!request.value().value) {  // a read changes nothing and is never a repetition
    if (under_way_->reads.at(command.drive->index()) >= kMaxReads) {
      return Error{.kind = ErrorKind::timeout, .detail = "too many reads under way; this one was not carried out"};
    }
    spawn(*command.drive, read_object(under_way_, *command.drive, request.value(), command.to), true);
    return {};
  }
  Result<void> checked = check_begin(incoming, command);
  if (checked.has_value()) {
    spawn(*command.drive, write_object(under_way_, *command.drive, origin_of(incoming), request.value(), command.to));
  }
  return checked;
}

void Requests::spawn(const process::Drive& drive, boost::asio::awaitable<void> work, bool is_read) {
  const std::size_t index = drive.index();
  ++(is_read ? under_way_->reads : under_way_->commands).at(index);
  ++under_way_->total;
  boost::asio::co_spawn(executor_, std::move(work),
                        [under_way = under_way_, index, is_read](std::exception_ptr failure) {
                          under_way->ended(index, is_read);
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
