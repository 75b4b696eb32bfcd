#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "bridges/process/inputs.h"
#include "tests/unit/process/test_drive.h"

namespace process {

/// Inputs driven by hand: TPDO values, time, and answers to what they want read.
class InputsTest : public ::testing::Test, public Inputs::Listener {
 protected:
  using Duration = canopen::Duration;
  using Raw = canopen::Raw;
  using TimePoint = canopen::TimePoint;
  using Problems = std::vector<alarms::DataProblem>;

  InputsTest() { build(); }

  void build() {
    image_ = std::make_unique<Image>(model_);
    inputs_ = std::make_unique<Inputs>(
        model_, *image_, [this](std::uint16_t tpdo) { return verified_.contains(tpdo); }, *this);
    values_.clear();
    stale_.clear();
  }

  void go_live() { inputs_->on_status(true, true, now_); }

  void tpdo1(Raw status, Raw current = 0, Raw frequency = 0) {
    inputs_->on_tpdo(1, std::vector<Raw>{status, current, frequency}, now_, {});
  }
  void tpdo2(Raw fault_code) { inputs_->on_tpdo(2, std::vector<Raw>{fault_code}, now_, {}); }

  // Time passes in small steps, so that nothing fires late.
  void pass(Duration time) {
    for (const TimePoint end = now_ + time; now_ < end;) {
      now_ += std::chrono::milliseconds(1);
      if (now_ >= inputs_->next_expiry()) {
        inputs_->expire(now_);
      }
    }
  }

  // Answers every read that is due; returns the objects in the order they were asked for.
  std::vector<canopen::ObjectAddress> answer_reads() {
    std::vector<canopen::ObjectAddress> asked;
    while (const auto job = inputs_->next_read(now_)) {
      asked.push_back(job->object);
      const auto known = objects_.find(job->object);
      if (known != objects_.end()) {
        inputs_->on_read(*job, known->second, now_, {});
      } else {
        canopen::Error absent;
        absent.kind = canopen::ErrorKind::refused;
        absent.abort = 0x06020000;
        inputs_->on_read(*job, absent, now_, {});
      }
      if (asked.size() > 100) {
        ADD_FAILURE() << "reading does not end";
        break;
      }
    }
    return asked;
  }

  [[nodiscard]] SignalId signal(std::string_view name) const { return test::id(model_, name); }
  [[nodiscard]] bool fresh(std::string_view name) const { return image_->fresh(signal(name), now_); }
  [[nodiscard]] Raw raw(std::string_view name) const { return image_->raw(signal(name)); }

  void on_values(SourceId source) override { values_.push_back(source); }
  void on_stale(SourceId source) override { stale_.push_back(source); }
  void on_watch_failed(SourceId source) override { watch_failed_.push_back(source); }
  void on_presence(SourceId source) override { presence_.push_back(source); }
  void on_problems() override { ++problems_told_; }
  void on_remark(const std::string& text) override { remarks_.push_back(text); }
  void on_read_wanted() override { ++reads_wanted_; }

  config::Drive model_ = test::drive();
  std::set<std::uint16_t> verified_{1, 2};
  std::map<canopen::ObjectAddress, Raw> objects_{{test::kTemperature, 315}, {test::kLimit, 5000}};
  std::unique_ptr<Image> image_;
  std::unique_ptr<Inputs> inputs_;
  TimePoint now_{std::chrono::hours(1)};
  std::vector<SourceId> values_;
  std::vector<SourceId> stale_;
  std::vector<SourceId> watch_failed_;
  std::vector<SourceId> presence_;
  std::vector<std::string> remarks_;
  int problems_told_ = 0;
  int reads_wanted_ = 0;
};

}  // namespace process
