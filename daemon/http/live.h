#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/process/observer.h"
#include "bridges/process/plant.h"
#include "canopen/clock.h"
#include "daemon/http/alarm_list.h"

namespace gateway::http {

/// What changed, for readers of `/api/live`. A change costs a number, however many read. What is shown is worded once
/// for all of them, and only when one asks.
class Live final : public process::Observer {
 public:
  /// How often a reader is told.
  static constexpr canopen::Duration kPace = std::chrono::milliseconds(250);
  /// So often it hears something at least.
  static constexpr canopen::Duration kSilence = std::chrono::seconds(15);
  /// Of one piece of the stream; what does not fit comes with the next. One list of alarms may be longer.
  static constexpr std::size_t kMostBytes = 64UL * 1024;
  /// Drives that are worded for one piece; likewise.
  static constexpr std::size_t kMostWorded = 8;

  /// One reader's place in the stream.
  struct Place {
    std::uint64_t health = 0;  ///< What it was told of each: the number of the change.
    std::uint64_t alarms = 0;
    std::vector<std::uint64_t> drives;
    std::size_t next = 0;             ///< The drive that it is told of next, if that changed.
    std::uint64_t configuration = 0;  ///< Plant::changes() that `drives` is of.
    bool more = false;                ///< The newest piece was full: the next one is due at once.
  };

  /// Added to the plant's observers; the plant outlives it.
  explicit Live(const process::Plant& plant);

  [[nodiscard]] Place begin() const {
    return {.drives = std::vector<std::uint64_t>(drives_.size(), 0),
            .next = 0,
            .configuration = plant_.changes(),
            .more = false};
  }
  /// Events for all that changed since this place, and moves it on. Empty: nothing did. `health`: the JSON of it.
  template <class Health>
  [[nodiscard]] std::string take(Place& place, Health health) {
    std::string out;
    if (place.health < health_) {
      append_event(out, "health", health());
      place.health = health_;
    }
    append_rest(out, place);
    return out;
  }
  /// `event: NAME`, and the data in one line.
  static void append_event(std::string& out, std::string_view name, std::string_view json);

  void on_values(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_freshness(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_commanded(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_control(const process::Drive& drive) override;
  void on_status(const process::Drive& drive) override;
  void on_alarm(const process::Drive& drive, alarms::AlarmKind kind) override;
  void on_bus(std::size_t bus) override;
  void on_bus_alarm(std::size_t bus) override;
  void on_plant_change(const process::PlantChange& change) override;

 private:
  struct Shown {
    std::uint64_t changed = 1;
    std::uint64_t worded = 0;  ///< The change that `text` shows,
    canopen::TimePoint at{};   ///< and when that was: it holds ages.
    std::string text;
    std::vector<std::optional<canopen::Raw>> values{};  ///< By signal; nothing: not fresh, or never heard.
  };

  /// A list of alarms that is being worded.
  struct Begun {
    AlarmList list;
    std::uint64_t change = 0;  ///< The newest that it shows.
    canopen::TimePoint at{};
    std::string text;
  };

  void append_rest(std::string& out, Place& place);
  [[nodiscard]] Shown make_shown(std::size_t drive) const;
  /// A piece's work on the list of alarms. False: there is more to word.
  [[nodiscard]] bool word_alarms();
  [[nodiscard]] static bool is_worded(const Shown& shown);
  void word(std::size_t drive);

  const process::Plant& plant_;
  std::vector<Shown> drives_;
  std::uint64_t health_ = 1;
  std::uint64_t alarms_ = 1;
  std::uint64_t alarms_worded_ = 0;  ///< The change that `alarms_text_` shows.
  std::string alarms_text_;
  std::optional<Begun> alarms_begun_;
};

}  // namespace gateway::http
