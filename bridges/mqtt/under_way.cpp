#include "bridges/mqtt/under_way.h"

#include <optional>
#include <string>

#include "bridges/process/stop_all.h"
#include "canopen/error.h"
#include "canopen/object.h"

namespace mqtt {

using canopen::Result;

namespace {

// The node, the object and the abort are not what whoever stops a plant looks for first.
std::string short_text(const canopen::Error& error) {
  if (error.detail.empty()) {
    return canopen::to_string(error);
  }
  return error.detail + (error.outcome_unknown ? ", outcome unknown" : "");
}

// One outcome for all: the kind is that of the first that was missed, and all of them are named.
process::Outcome outcome_of_all(const process::Plant& plant, const process::Writer& writer,
                                const std::vector<process::NotStopped>& missed) {
  if (!process::commands_any(plant, writer)) {
    return canopen::Error{.kind = canopen::ErrorKind::forbidden, .detail = "no drive takes commands of this writer"};
  }
  if (missed.empty()) {
    return {};
  }
  std::string names;
  for (const process::NotStopped& one : missed) {
    names += (names.empty() ? "" : "; ") + plant.drive(one.drive).model().name + " (" + short_text(one.error) + ")";
  }
  return canopen::Error{.kind = missed.front().error.kind, .detail = "not confirmed: " + names};
}

}  // namespace

boost::asio::awaitable<void> write_fields(std::shared_ptr<UnderWay> under_way, process::Drive& drive,
                                          process::Origin origin, std::vector<process::FieldWrite> fields, ReplyTo to) {
  const process::Outcome outcome = co_await drive.write(std::move(origin), std::move(fields));
  under_way->send(command_answer(to, outcome));
}

boost::asio::awaitable<void> stop_every_drive(std::shared_ptr<UnderWay> under_way, process::Plant& plant,
                                              process::Origin origin, ReplyTo to) {
  const process::Writer writer = origin.writer;
  const std::vector<process::NotStopped> missed = co_await process::stop_all(plant, std::move(origin));
  under_way->send(command_answer(to, outcome_of_all(plant, writer, missed)));
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

}  // namespace mqtt
