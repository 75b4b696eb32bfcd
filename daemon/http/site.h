#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "bridges/modbus/counts.h"
#include "bridges/mqtt/broker.h"
#include "bridges/process/health.h"
#include "bridges/process/plant.h"
#include "bridges/recorder/stored_records.h"
#include "daemon/http/answer.h"
#include "daemon/http/command_tally.h"
#include "daemon/http/page.h"
#include "daemon/http/process_figures.h"
#include "daemon/surveys.h"

namespace trace {
class Feed;
}

namespace gateway::http {

struct ModbusFigures {
  std::size_t clients = 0;
  std::uint64_t refused = 0;  ///< Connections.
  modbus::Counts counts{};
};

struct MqttFigures {
  bool connected = false;
  mqtt::BrokerCounts counts{};
  std::uint64_t put_right = 0;  ///< Topics that others had overwritten.
  std::size_t refused_subscriptions = 0;
};

struct JournalFigures {
  std::uint64_t lost = 0;       ///< Lines that were never written.
  std::uint64_t passed_by = 0;  ///< Commands that did not wait for their line.
};

struct RecorderFigures {
  bool works = true;       ///< See recorder::RecordKeeper::works().
  std::uint64_t lost = 0;  ///< Records that were given up.
};

/// Of this server itself.
struct HttpFigures {
  std::size_t clients = 0;
  std::uint64_t refused = 0;                    ///< Connections.
  std::map<unsigned, std::uint64_t> answers{};  ///< By status.
};

/// All that may be looked at. Nothing of it changes anything. What it points to outlives it; an empty function stands
/// for what this gateway does not have.
struct Site {
  const process::Plant& plant;
  const CommandTally& commands;
  std::string version;
  std::shared_ptr<const std::string> map;  ///< As `map --format json` prints it; another one after a reload.
  std::function<process::Health()> health;
  std::string charts = chart_library();
  std::function<ProcessFigures()> process = process_figures;
  std::function<ModbusFigures()> modbus{};
  std::function<MqttFigures()> mqtt{};
  std::function<Pieces(std::size_t drive)> history{};  ///< See History::json(); always there.
  std::function<JournalFigures()> journal{};
  std::function<const std::deque<std::string>&()> journal_lines{};  ///< The newest, oldest first.
  std::function<HttpFigures()> http{};
  trace::Feed* trace = nullptr;  ///< Only looks at the buses.
  Surveys survey{};
  /// Those on the disk; nothing inside: they cannot be looked at now.
  std::function<const std::optional<recorder::StoredRecords>&()> records{};
  /// A piece of a file of theirs; there where `records` is. See recorder::RecordReader::read().
  std::function<boost::asio::awaitable<std::optional<std::string>>(std::string name, std::uint64_t offset)>
      read_record{};
  std::function<RecorderFigures()> recorder{};
};

}  // namespace gateway::http
