#include "daemon/control/plant_service.h"

#include <string_view>
#include <utility>
#include <vector>

#include "bridges/mqtt/command.h"
#include "bridges/mqtt/sdo_request.h"
#include "bridges/process/stop_all.h"
#include "daemon/bus_report.h"
#include "daemon/control/answer.h"
#include "daemon/control/status_json.h"

namespace gateway::control {
namespace {

using boost::asio::awaitable;
using canopen::Error;
using canopen::ErrorKind;
using canopen::Result;
using process::Drive;
using process::Plant;
using text::Scalar;

process::Writer writer_of(const Asked& asked) {
  return {.way = process::Writer::Way::local, .address = {}, .user = asked.user};
}

process::Origin origin_of(const Asked& asked) {
  return {.writer = writer_of(asked), .received = asked.received};
}

std::string no_drive(const Asked& asked) {
  return refusal(asked.id, {.kind = ErrorKind::unknown, .detail = "no drive \"" + asked.request.drive + "\""});
}

using Kind = process::CommandRecord::Kind;

std::string refused(const Asked& asked, Drive& drive, Kind kind, const Error& error) {
  return told_outcome(asked.id, drive.refuse(origin_of(asked), kind, error));
}

Scalar text(const std::string& characters) {
  return {Scalar::Kind::string, characters};
}

// The type of the signal with this object; nothing without one.
std::optional<canopen::DataType> type_of(const config::Drive& drive, std::string_view object) {
  const auto address = canopen::parse_object(object);
  for (const config::Signal& signal : drive.signals) {
    if (address && signal.object == *address && !signal.derived) {
      return signal.type;
    }
  }
  return std::nullopt;
}

Result<mqtt::SdoRequest> sdo_request_of(const config::Drive& drive, const Request& request) {
  std::optional<std::string> type = request.type;
  if (!type && canopen::parse_object(request.object)) {
    const auto known = type_of(drive, request.object);
    if (!known) {
      return Error{
          .kind = ErrorKind::type,
          .detail = "\"type\" is missing, and no signal of " + drive.name + " has the object " + request.object};
    }
    type = std::string(canopen::name_of(*known));
  }
  text::FlatObject members{{"op", text(request.op == Op::sdo_read ? "read" : "write")},
                           {"object", text(request.object)},
                           {"type", text(type.value_or(""))}};
  if (request.value) {
    members.emplace_back("value", *request.value);
  }
  return mqtt::sdo_request_of(members);
}

// Something beside the stop is no value of the drive: the stop is carried out, and what is wrong is told.
awaitable<std::string> stop_all_the_same(Drive& drive, Asked asked, std::vector<process::FieldWrite> stop,
                                         Error wrong) {
  process::Origin origin = origin_of(asked);
  const process::Outcome outcome = co_await drive.write(std::move(origin), std::move(stop));
  if (outcome.has_error()) {
    co_return refusal(asked.id, outcome.error());
  }
  (void)drive.refuse(origin_of(asked), Kind::write, wrong);  // beside the stop, which has lines of its own
  wrong.detail += "; nothing but the stop was sent, and it was confirmed";
  co_return refusal(asked.id, wrong);
}

awaitable<std::string> set(Plant& plant, Asked asked) {
  Drive* const drive = plant.find(asked.request.drive);
  if (drive == nullptr) {
    co_return no_drive(asked);
  }
  mqtt::Fields fields = mqtt::fields_of(drive->model(), asked.request.values);
  if (fields.mistake) {
    std::erase_if(fields.sound, [drive](const process::FieldWrite& field) { return !drive->is_stop({&field, 1}); });
    if (fields.sound.empty()) {
      co_return refused(asked, *drive, Kind::write, *fields.mistake);
    }
    std::string told = co_await stop_all_the_same(*drive, std::move(asked), std::move(fields.sound), *fields.mistake);
    co_return told;
  }
  process::Origin origin = origin_of(asked);
  const process::Outcome outcome = co_await drive->write(std::move(origin), std::move(fields.sound));
  co_return told_outcome(asked.id, outcome);
}

awaitable<std::string> nmt(Plant& plant, Asked asked) {
  Drive* const drive = plant.find(asked.request.drive);
  if (drive == nullptr) {
    co_return no_drive(asked);
  }
  const Result<canopen::NmtCommand> command = mqtt::nmt_command_of({{"value", text(asked.request.command)}});
  if (command.has_error()) {
    co_return refused(asked, *drive, Kind::nmt, command.error());
  }
  process::Origin origin = origin_of(asked);
  const process::Outcome outcome = co_await drive->nmt(std::move(origin), command.value());
  co_return told_outcome(asked.id, outcome);
}

awaitable<process::Outcome> write_object(Drive& drive, process::Origin origin, mqtt::SdoRequest request) {
  if (request.value) {
    const canopen::ObjectValue value{request.object, request.type, *request.value};
    process::Outcome outcome = co_await drive.sdo_write(std::move(origin), value);
    co_return outcome;
  }
  process::Outcome outcome = co_await drive.sdo_write(std::move(origin), request.object, std::move(request.data));
  co_return outcome;
}

awaitable<std::string> read_object(Drive& drive, std::string id, mqtt::SdoRequest request) {
  if (request.form == mqtt::SdoForm::number) {
    const Result<canopen::Raw> read = co_await drive.sdo_read(request.object, request.type);
    co_return read.has_error() ? refusal(id, read.error()) : read_value(id, request.type, read.value());
  }
  const Result<std::vector<std::uint8_t>> read = co_await drive.sdo_read(request.object);
  co_return read.has_error() ? refusal(id, read.error()) : read_data(id, request.form, read.value());
}

awaitable<std::string> sdo(Plant& plant, Asked asked) {
  Drive* const drive = plant.find(asked.request.drive);
  if (drive == nullptr) {
    co_return no_drive(asked);
  }
  Result<mqtt::SdoRequest> request = sdo_request_of(drive->model(), asked.request);
  if (asked.request.op == Op::sdo_write) {
    if (request.has_error()) {
      co_return refused(asked, *drive, Kind::raw, request.error());
    }
    process::Origin origin = origin_of(asked);
    const process::Outcome outcome = co_await write_object(*drive, std::move(origin), std::move(request.value()));
    co_return told_outcome(asked.id, outcome);
  }
  if (request.has_error()) {
    co_return refusal(asked.id, request.error());
  }
  std::string answer = co_await read_object(*drive, asked.id, std::move(request.value()));
  co_return answer;
}

awaitable<std::string> stop(Plant& plant, Asked asked) {
  const std::size_t drives = process::commanded_by(plant, writer_of(asked));
  process::Origin origin = origin_of(asked);
  const std::vector<process::NotStopped> not_stopped = co_await process::stop_all(plant, std::move(origin));
  co_return stop_answer(asked.id, drives, not_stopped);
}

/// What is told beside the drives.
struct Beside {
  canopen::TimePoint started;
  Surveys surveys;
  RecordRequest record;
};

awaitable<std::string> status(const Plant& plant, Asked asked, Beside beside) {
  co_return told_status(asked.id, status_json(plant, beside.started, canopen::Clock::now(), beside.surveys));
}

awaitable<std::string> buses(const Plant& plant, Asked asked, Beside beside) {
  co_return told_buses(asked.id, bus_reports(plant, beside.surveys));
}

awaitable<std::string> record(const Plant& plant, Asked asked, Beside beside) {
  co_return record_answer(asked, plant, beside.record);
}

awaitable<std::string> answer(Plant& plant, Asked asked, Beside beside) {
  switch (asked.request.op) {
    case Op::set:
      return set(plant, std::move(asked));
    case Op::nmt:
      return nmt(plant, std::move(asked));
    case Op::sdo_read:
    case Op::sdo_write:
      return sdo(plant, std::move(asked));
    case Op::stop:
      return stop(plant, std::move(asked));
    case Op::buses:
      return buses(plant, std::move(asked), std::move(beside));
    case Op::record:
      return record(plant, std::move(asked), std::move(beside));
    case Op::status:
    case Op::trace:  // a stream, see streams.h
      break;
  }
  return status(plant, std::move(asked), std::move(beside));
}

bool is_stop(Plant& plant, const Request& request) {
  const Drive* const drive = request.op == Op::set ? plant.find(request.drive) : nullptr;
  return drive == nullptr ? request.op == Op::stop
                          : drive->is_stop(mqtt::fields_of(drive->model(), request.values).sound);
}

}  // namespace

Service plant_service(process::Plant& plant, Surveys surveys, RecordRequest record) {
  const Beside beside{canopen::Clock::now(), std::move(surveys), std::move(record)};
  return {.is_stop = [&plant](const Request& request) { return is_stop(plant, request); },
          .answer = [&plant, beside](Asked asked) { return answer(plant, std::move(asked), beside); }};
}

}  // namespace gateway::control
