#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridges/alarms/data_problem.h"
#include "bridges/process/image.h"
#include "bridges/process/sdo_round.h"
#include "bridges/process/source_plan.h"
#include "bridges/process/tpdo_watch.h"
#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/object.h"
#include "config/model.h"

namespace process {

/// An object to be read by SDO for a source.
struct ReadJob {
  SourceId source = 0;
  canopen::ObjectAddress object;
  canopen::DataType type = canopen::DataType::u16;
  std::uint32_t round = 0;
  canopen::TimePoint due{};  ///< Of the round.
};

/// The way of values into the image: TPDO values and SDO answers to signals, booleans out of words, freshness per
/// source, and which objects are to be read by SDO when. It has no timer and sends nothing: its owner calls expire() at
/// next_expiry() and carries out next_read() at next_read_at(), one at a time.
///
/// Parts: inputs.cpp values and freshness, inputs_reading.cpp what is read by SDO, inputs_problems.cpp what is wrong.
class Inputs {
 public:
  /// Told in the same call in which it happened; never calls back but for reading.
  class Listener {
   public:
    virtual void on_values(SourceId source) = 0;
    /// This source is not fresh any more.
    virtual void on_stale(SourceId source) = 0;
    /// The objects of a TPDO under watch() could not be read: nobody knows its next value, fresh as its last one is.
    virtual void on_watch_failed(SourceId source) = 0;
    /// SourceState::absent of this source changed.
    virtual void on_presence(SourceId source) = 0;
    /// problems() changed, or examined() became true.
    virtual void on_problems() = 0;
    /// For the log: something that a person should know and nothing acts upon.
    virtual void on_remark(const std::string& text) = 0;
    /// next_read_at() came nearer.
    virtual void on_read_wanted() = 0;

   protected:
    ~Listener() = default;
  };
  /// The transmission type of this TPDO is known, so that its period can be relied on.
  using Verified = std::function<bool(std::uint16_t tpdo)>;

  /// `model`, `image` and `listener` outlive it.
  Inputs(const config::Drive& model, Image& image, Verified verified, Listener& listener);
  Inputs(const Inputs&) = delete;
  Inputs& operator=(const Inputs&) = delete;

  void on_status(bool online, bool operational, canopen::TimePoint now);
  /// The drive rebooted: nothing counts as received.
  void on_boot_up();
  void on_tpdo(std::uint16_t number, std::span<const canopen::Raw> values, canopen::TimePoint at,
               canopen::WallTime wall);
  /// A shorter one is a problem; a longer one, of which the first bytes count, is remarked once.
  void on_tpdo_length(std::uint16_t number, std::size_t expected, std::size_t received, canopen::TimePoint now);
  /// No TPDO value is fresh until refreshed.
  void on_frames_lost(canopen::TimePoint now);

  [[nodiscard]] canopen::TimePoint next_expiry() const noexcept;
  void expire(canopen::TimePoint now);

  [[nodiscard]] canopen::TimePoint next_read_at() const noexcept;
  /// The object that is due first, where one is.
  [[nodiscard]] std::optional<ReadJob> next_read(canopen::TimePoint now);
  void on_read(const ReadJob& job, const canopen::Result<canopen::Raw>& answer, canopen::TimePoint at,
               canopen::WallTime wall);

  /// A command of a readable signal was confirmed: what was written is shown, and read back before everything else that
  /// is polled. A drive that holds something else is remarked.
  void on_written(SignalId signal, canopen::Raw raw, canopen::TimePoint at, canopen::WallTime wall);

  /// While set, an on-change TPDO is read by SDO at each poll too: somebody waits for its next value.
  void watch(SourceId source, bool watched, canopen::TimePoint now);
  /// How long three of them are what a value needs to be believed: the period of a TPDO, else the poll.
  [[nodiscard]] canopen::Duration period_of(SourceId source) const noexcept;

  [[nodiscard]] std::span<const SourcePlan> plans() const noexcept { return plans_; }
  /// What is wrong with TPDOs while the drive lives (overdue, not readable, too short), and which polled objects it
  /// does not have. The latter stays until the drive is asked again: at each arrival, and once a minute.
  [[nodiscard]] std::vector<alarms::DataProblem> problems() const;
  /// The drive came, and of every source something is known since: no further problem is to be expected of it as it is.
  [[nodiscard]] bool examined() const noexcept;

 private:
  struct Feed {
    explicit Feed(const SourcePlan& plan) : tpdo(plan), round(plan) {}

    TpdoWatch tpdo;  ///< Of no meaning for a polled object.
    SdoRound round;
    std::optional<alarms::DataProblem> problem;  ///< As last told.
    bool looked_at = false;                      ///< Since the drive came online.
    bool told_fresh = false;
    bool watched = false;
    bool told_longer = false;
    std::optional<canopen::Raw> written;  ///< And not read back yet.
  };

  [[nodiscard]] SourceId source_count() const noexcept { return static_cast<SourceId>(plans_.size()); }
  [[nodiscard]] bool is_tpdo(SourceId source) const noexcept;
  [[nodiscard]] bool is_cyclic(SourceId source) const noexcept;
  [[nodiscard]] bool live() const noexcept { return online_ && operational_; }
  [[nodiscard]] std::optional<SourceId> find_tpdo(std::uint16_t number) const noexcept;
  [[nodiscard]] bool reads_regularly(SourceId source) const noexcept;
  void begin_life(canopen::TimePoint now);
  void end_life();
  void reset_tpdo(SourceId source);
  void make_stale(SourceId source);
  void apply(SourceId source, std::span<const canopen::Raw> values, canopen::TimePoint at, canopen::WallTime wall,
             canopen::TimePoint fresh_until);
  void derive(const SourcePlan& plan) noexcept;
  void note_frame(SourceId source, canopen::TimePoint at);
  void on_round_complete(SourceId source, canopen::TimePoint at, canopen::WallTime wall);
  void on_round_failed(SourceId source, const canopen::Error& error, canopen::TimePoint at);
  void set_absent(SourceId source, bool absent);
  [[nodiscard]] std::optional<alarms::DataProblem> problem_of(SourceId source) const;
  void update_problem(SourceId source);
  void note_looked_at(SourceId source);
  void update_examined();

  const config::Drive& model_;
  Image& image_;
  Verified verified_;
  Listener& listener_;
  std::vector<SourcePlan> plans_;
  std::vector<Feed> feeds_;
  bool online_ = false;
  bool operational_ = false;
  bool told_examined_ = false;
};

}  // namespace process
