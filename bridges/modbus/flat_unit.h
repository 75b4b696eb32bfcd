#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bridges/modbus/drive_unit.h"
#include "bridges/modbus/exception.h"
#include "bridges/modbus/request.h"
#include "bridges/modbus/snapshot.h"
#include "bridges/process/command.h"

namespace modbus {

/// All drives that have a `flat` base as one unit, for clients that can ask one unit only: 0..899 of a drive's own unit
/// stand at its base, its diagnostics at base + 900. A read may go over several drives; what is written in one request
/// is of one drive.
class FlatUnit {
 public:
  /// `unit` outlives this. Blocks do not overlap, the configuration sees to that.
  void add(std::uint16_t base, DriveUnit& unit) { blocks_.push_back({base, &unit}); }

  [[nodiscard]] std::optional<Exception> read(const Request& request, canopen::TimePoint now, Snapshot& into) const;
  /// Of each drive that the request reads or writes.
  void sign_of_life(const Request& request, const process::Writer& writer);
  /// Whose address the first one written is; null: no drive's.
  [[nodiscard]] const DriveUnit* written_by(const Request& request) const;
  [[nodiscard]] bool is_stop(const Request& request) const;
  Exception note_refused(const Request& request, process::Origin origin, canopen::Error why);
  void remark(const Request& request, const std::string& text);
  [[nodiscard]] boost::asio::awaitable<std::optional<Exception>> write(Request request, process::Origin origin);

 private:
  struct Block {
    std::uint16_t base = 0;
    DriveUnit* unit = nullptr;
  };
  /// The beginning of a range, as the drive's own unit has it.
  struct Part {
    DriveUnit* unit = nullptr;
    Range range;
  };

  /// As much of `range` as one drive has without a gap; nothing where its first address is no drive's.
  [[nodiscard]] std::optional<Part> first_part(Range range) const;
  /// The request as the drive's own unit has it. Nothing: not all that it writes is of one drive.
  [[nodiscard]] std::optional<std::pair<DriveUnit*, Request>> own(const Request& request) const;

  std::vector<Block> blocks_;
};

}  // namespace modbus
