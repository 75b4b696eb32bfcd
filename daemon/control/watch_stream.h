#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "bridges/process/plant.h"
#include "canopen/clock.h"
#include "daemon/control/stream.h"
#include "daemon/surveys.h"

namespace gateway::control {

/// How the gateway is, `{"id":1,"status":{…}}`: at once, then at each change, at most twice a second, and each five
/// seconds at least. Time alone, and what the load of a bus is, are no change.
class WatchStream final : public Stream {
 public:
  static constexpr canopen::Duration kPace = std::chrono::milliseconds(500);
  static constexpr canopen::Duration kSilence = std::chrono::seconds(5);

  /// `id`: JSON text. `plant` outlives it.
  WatchStream(const process::Plant& plant, std::string id, canopen::TimePoint started, Surveys surveys = {});

  [[nodiscard]] bool take(std::string& lines) override;
  [[nodiscard]] canopen::Duration pace() const override { return kPace; }

 private:
  static constexpr std::size_t kDrivesAtOnce = 4;

  void begin();
  void add_drive();
  void note(std::size_t hash) noexcept { hash_ = hash_ * 31 + hash; }

  const process::Plant& plant_;
  std::string id_;
  canopen::TimePoint started_;
  Surveys surveys_;
  std::uint64_t configuration_ = 0;   ///< Plant::changes() of the status that is worded.
  std::optional<std::size_t> drive_;  ///< The next one to be worded; nothing: a status is to be begun.
  std::string status_;
  std::size_t hash_ = 0;  ///< Of all that is a change where it is another.
  std::optional<std::size_t> told_{};
  canopen::TimePoint told_at_{};
};

}  // namespace gateway::control
