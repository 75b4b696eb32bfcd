#include "daemon/http/history.h"

#include <algorithm>
#include <boost/system/error_code.hpp>
#include <chrono>
#include <limits>

#include "bridges/process/plant_change.h"
#include "bridges/text/json_text.h"
#include "bridges/text/timestamp.h"
#include "canopen/object.h"

namespace gateway::http {
namespace {

// The shortest digits of a float, some seven at most.
void append_sample(std::string& out, float value) {
  if (!text::append_number(out, value)) {
    out += "null";
  }
}

}  // namespace

History::History(const boost::asio::any_io_executor& executor, const process::Plant& plant)
    : plant_(plant), timer_(executor) {
  begin();
}

History::Trend History::make_trend(std::size_t drive) const {
  Trend trend;
  const config::Drive& model = plant_.drive(drive).model();
  for (std::size_t signal = 0; signal < model.signals.size(); ++signal) {
    if (config::readable(model.signals[signal].access)) {
      trend.signals.push_back(static_cast<process::SignalId>(signal));
    }
  }
  trend.values.assign(rows_ * trend.signals.size(), std::numeric_limits<float>::quiet_NaN());
  return trend;
}

std::size_t History::room() const {
  std::size_t bytes_of_row = 0;
  for (std::size_t i = 0; i < plant_.size(); ++i) {
    const std::vector<config::Signal>& signals = plant_.drive(i).model().signals;
    bytes_of_row += sizeof(float) * static_cast<std::size_t>(std::ranges::count_if(
                                        signals, [](const auto& signal) { return config::readable(signal.access); }));
  }
  return std::clamp<std::size_t>(kMostBytes / std::max<std::size_t>(bytes_of_row, 1), 1, kSamples);
}

void History::begin() {
  rows_ = room();
  times_.assign(rows_, {});
  taken_ = 0;
  trends_.clear();
  for (std::size_t i = 0; i < plant_.size(); ++i) {
    trends_.push_back(make_trend(i));
  }
}

void History::on_plant_change(const process::PlantChange& change) {
  if (room() != rows_) {
    begin();
    return;
  }
  trends_ = process::realigned(std::move(trends_), change.drives, [this](std::size_t i) { return make_trend(i); });
}

void History::start() {
  runs_ = true;
  timer_.expires_after(kPeriod);
  arm();
}

void History::stop() {
  runs_ = false;
  timer_.cancel();
}

// From one expiry to the next: late turns of the loop add nothing up. One that was stopped may have expired before.
void History::arm() {
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (error || !runs_) {
      return;
    }
    sample();
    const canopen::TimePoint next = timer_.expiry() + kPeriod;
    timer_.expires_at(std::max(next, canopen::Clock::now()));
    arm();
  });
}

void History::sample() {
  const canopen::TimePoint now = canopen::Clock::now();
  const std::size_t at = static_cast<std::size_t>(taken_ % rows_);
  times_[at] = canopen::wall_now();
  for (std::size_t i = 0; i < trends_.size(); ++i) {
    const process::Drive& drive = plant_.drive(i);
    Trend& trend = trends_[i];
    for (std::size_t k = 0; k < trend.signals.size(); ++k) {
      const process::SignalId id = trend.signals[k];
      const config::Signal& signal = drive.model().signals[id];
      trend.values[at * trend.signals.size() + k] =
          drive.image().fresh(id, now)
              ? static_cast<float>(canopen::to_number(signal.type, drive.image().raw(id)) * signal.scale)
              : std::numeric_limits<float>::quiet_NaN();
    }
  }
  ++taken_;
}

void History::append_row(std::string& out, const Trend& trend, std::size_t row) const {
  out += '[';
  text::append_quoted(out, text::timestamp(times_[row]));
  for (std::size_t k = 0; k < trend.signals.size(); ++k) {
    out += ',';
    append_sample(out, trend.values[row * trend.signals.size() + k]);
  }
  out += ']';
}

std::string History::begin_json(std::size_t drive) const {
  const config::Drive& model = plant_.drive(drive).model();
  std::string out;
  text::ObjectText object(out);
  object.text("drive", model.name);
  object.integer("period", std::chrono::floor<std::chrono::seconds>(kPeriod).count());
  text::append_list(object.key("signals"), trends_[drive].signals, [&model](std::string& to, process::SignalId id) {
    text::append_quoted(to, model.signals[id].name);
  });
  object.key("samples") += '[';
  return out;
}

Pieces History::json(std::size_t drive) const {
  const Trend& trend = trends_[drive];
  const std::uint64_t rows = std::max<std::size_t>(kValuesOfPiece / (trend.signals.size() + 1), 1);
  const std::uint64_t oldest = taken_ - std::min<std::uint64_t>(taken_, rows_);
  return [this, drive, rows, next = oldest, end = taken_, begun = false, head = begin_json(drive),
          configuration = plant_.changes()](std::string& out) mutable {
    out += begun ? "" : head;
    if (configuration != plant_.changes()) {
      out += "]}";
      return Progress{};
    }
    next = std::max(next, taken_ - std::min<std::uint64_t>(taken_, rows_));
    for (const std::uint64_t stop = std::min(next + rows, end); next < stop; ++next) {
      out += out.ends_with('[') ? "" : ",";
      append_row(out, trends_[drive], static_cast<std::size_t>(next % rows_));
    }
    begun = true;
    out += next < end ? "" : "]}";
    return Progress{.goes_on = next < end};
  };
}

}  // namespace gateway::http
