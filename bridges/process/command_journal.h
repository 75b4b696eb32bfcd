#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bridges/process/command.h"
#include "bridges/process/image.h"
#include "bridges/process/writer.h"
#include "canopen/clock.h"
#include "canopen/nmt.h"
#include "canopen/object.h"
#include "config/model.h"

namespace process {

/// One signal of a command, as raw values.
struct FieldRecord {
  SignalId signal = 0;
  std::optional<canopen::Raw> before{};  ///< What the drive was known to hold; only where that was fresh.
  std::optional<canopen::Raw> asked{};   ///< Whatever its limits; nothing: no value of the signal is that.
  std::optional<double> given{};         ///< In its place: the number that is no value, in engineering units.
  std::optional<canopen::Raw> confirmed{};
};

/// A command as it is kept.
struct CommandRecord {
  enum class Kind : std::uint8_t { write, nmt, raw };

  Kind kind = Kind::write;
  std::string id;  ///< As in the answer and the log.
  Writer writer;
  const config::Drive* drive = nullptr;          ///< Outlives the record.
  std::vector<FieldRecord> fields;               ///< Of a write.
  std::optional<canopen::NmtCommand> nmt{};      ///< Of an NMT command.
  std::optional<canopen::ObjectValue> object{};  ///< Of a raw write.
  std::vector<std::uint8_t> bytes{};             ///< Of one in no basic type: what stands for the value of `object`.
  bool writes_control = false;                   ///< It may start or stop the motor.
  canopen::TimePoint arrived{};
  canopen::WallTime wall{};  ///< Of its arrival, for people.
};

/// Keeps what was commanded. Never fails a command: what it cannot keep it tells.
class CommandJournal {
 public:
  /// A command that writes `control_command` is about to be handed over. Returns once that is written, or could not be
  /// in a short time.
  virtual boost::asio::awaitable<void> begun(const CommandRecord& record) = 0;
  /// What became of it. Does not wait.
  virtual void done(const CommandRecord& record, const Outcome& outcome) = 0;

 protected:
  ~CommandJournal() = default;
};

}  // namespace process
