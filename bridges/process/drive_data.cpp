// What is wrong with the data of a drive: its TPDOs, its objects, its emergencies.

#include "bridges/process/drive.h"

namespace process {

void Drive::on_problems() {
  std::vector<alarms::DataProblem> problems = inputs_.problems();
  if (emcy_problem_) {
    problems.push_back(*emcy_problem_);
  }
  // Before all was looked at nobody knows whether what was wrong before our start is over.
  data_known_ = data_known_ || !problems.empty() || inputs_.examined();
  if (data_known_) {
    alarms_.on_data_problems(problems, canopen::wall_now());
  }
}

void Drive::on_emcy_checked(const canopen::EmcyVerdict& verdict) {
  using alarms::DataReason;
  emcy_problem_.reset();
  if (verdict.service != canopen::EmcyService::as_expected) {
    const bool off = verdict.service == canopen::EmcyService::off;
    emcy_problem_ = {off ? DataReason::emcy_off : DataReason::emcy_moved, verdict.text};
  }
  on_problems();
}

void Drive::on_watch_failed(SourceId source) {
  tell_stale_bit(fault_, config::Severity::fault, source);
  tell_stale_bit(warning_, config::Severity::warning, source);
}

}  // namespace process
