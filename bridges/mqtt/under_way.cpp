#include "bridges/mqtt/under_way.h"

#include <algorithm>
#include <string>
#include <variant>

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
process::Outcome outcome_of_all(const std::vector<process::NotStopped>& missed) {
  if (missed.empty()) {
    return {};
  }
  std::string names;
  for (const process::NotStopped& one : missed) {
    names += (names.empty() ? "" : "; ") + one.name + " (" + short_text(one.error) + ")";
  }
  return canopen::Error{.kind = missed.front().error.kind, .detail = "not confirmed: " + names};
}

boost::asio::awaitable<process::Outcome> stop_all_drives(process::Plant& plant, process::Origin origin) {
  const bool for_none = process::commanded_by(plant, origin.writer) == 0;
  const std::vector<process::NotStopped> missed = co_await process::stop_all(plant, std::move(origin));
  if (for_none) {
    co_return canopen::Error{.kind = canopen::ErrorKind::forbidden, .detail = "no drive takes commands of this writer"};
  }
  co_return outcome_of_all(missed);
}

boost::asio::awaitable<process::Outcome> write_fields(process::Drive& drive, process::Origin origin, Fields fields) {
  process::Origin of_mistake = origin;
  process::Outcome outcome = co_await drive.write(std::move(origin), std::move(fields.sound));
  if (outcome.has_value() && fields.mistake) {
    // The stop has lines of its own in the journal.
    (void)drive.refuse(std::move(of_mistake), process::CommandRecord::Kind::write, *fields.mistake);
    outcome.failure = std::move(fields.mistake);
    outcome.failure->detail += "; the stop beside it was carried out";
  }
  co_return outcome;
}

boost::asio::awaitable<Message> read_object(process::Drive& drive, SdoRequest request, ReplyTo to) {
  if (request.form == SdoForm::number) {
    const Result<canopen::Raw> read = co_await drive.sdo_read(request.object, request.type);
    co_return sdo_answer(to, read, request.type);
  }
  const Result<std::vector<std::uint8_t>> read = co_await drive.sdo_read(request.object);
  co_return sdo_answer(to, read, request.form);
}

boost::asio::awaitable<process::Outcome> write_object(process::Drive& drive, process::Origin origin,
                                                      SdoRequest request) {
  if (request.value) {
    const canopen::ObjectValue value{request.object, request.type, *request.value};
    process::Outcome outcome = co_await drive.sdo_write(std::move(origin), value);
    co_return outcome;
  }
  process::Outcome outcome = co_await drive.sdo_write(std::move(origin), request.object, std::move(request.data));
  co_return outcome;
}

}  // namespace

UnderWay::UnderWay(const boost::asio::any_io_executor& executor, process::Plant& plant, Publish to_publish)
    : publish(std::move(to_publish)), idle(executor) {
  for (std::size_t i = 0; i < plant.size(); ++i) {
    loads.push_back(std::make_shared<DriveLoad>(DriveLoad{.drive = &plant.drive(i)}));
  }
}

void UnderWay::change(process::Plant& plant, const process::PlantChange& change) {
  const std::vector<std::shared_ptr<DriveLoad>> before = loads;
  loads = process::realigned(loads, change.drives, [&plant](std::size_t i) {
    return std::make_shared<DriveLoad>(DriveLoad{.drive = &plant.drive(i)});
  });
  for (const std::shared_ptr<DriveLoad>& each : before) {
    if (std::ranges::find(loads, each) == loads.end()) {
      each->drive = nullptr;
    }
  }
}

void UnderWay::begins(DriveLoad* load, bool is_read) {
  ++total;
  reads += is_read ? 1 : 0;
  if (load != nullptr) {
    ++(is_read ? load->reads : load->commands);
  }
}

void UnderWay::ended(DriveLoad* load, bool is_read) {
  --total;
  reads -= is_read ? 1 : 0;
  if (load != nullptr) {
    --(is_read ? load->reads : load->commands);
  }
  if (total == 0) {
    idle.cancel();
  }
}

void UnderWay::settle(const Asker& asker, const process::Outcome& outcome) {
  send(command_answer(asker.to, outcome));
  if (asker.ticket == Duplicates::kNone) {
    return;
  }
  const std::string first = first_outcome(outcome);
  if (may_come_again(outcome)) {
    duplicates.forget(asker.ticket);
  } else {
    duplicates.settle(asker.ticket, first);
  }
  const auto [begin, end] = waiting.equal_range(asker.ticket);
  for (auto repetition = begin; repetition != end; ++repetition) {
    send(duplicate_answer(repetition->second, first));
  }
  waiting.erase(begin, end);
}

void UnderWay::repeat(const ReplyTo& to, const Duplicates::Earlier& earlier) {
  if (earlier.first || waiting.size() >= kMaxWaiting) {
    send(duplicate_answer(to, earlier.first));
  } else {
    waiting.emplace(earlier.ticket, to);
  }
}

boost::asio::awaitable<void> carry_out(std::shared_ptr<UnderWay> under_way, process::Plant& plant,
                                       std::shared_ptr<DriveLoad> load, process::Origin origin, Asked asked,
                                       Asker asker) {
  process::Drive* const drive = load == nullptr ? nullptr : load->drive;
  process::Outcome outcome;
  if (load == nullptr) {
    outcome = co_await stop_all_drives(plant, std::move(origin));
  } else if (drive == nullptr) {
    outcome = canopen::Error{.kind = canopen::ErrorKind::offline, .detail = "the drive was taken out of the plant"};
  } else if (auto* fields = std::get_if<Fields>(&asked)) {
    outcome = co_await write_fields(*drive, std::move(origin), std::move(*fields));
  } else if (const auto* nmt = std::get_if<canopen::NmtCommand>(&asked)) {
    outcome = co_await drive->nmt(std::move(origin), *nmt);
  } else {
    auto request = std::get<SdoRequest>(std::move(asked));
    if (!request.writes()) {
      Message answer = co_await read_object(*drive, std::move(request), asker.to);
      under_way->send(std::move(answer));
      co_return;
    }
    outcome = co_await write_object(*drive, std::move(origin), std::move(request));
  }
  under_way->settle(asker, outcome);
}

}  // namespace mqtt
