#include "bridges/recorder/command_trail.h"

#include <utility>

#include "bridges/journal/record_text.h"
#include "bridges/text/timestamp.h"

namespace recorder {
namespace {

// Of a write of many bytes: what was written is in the frames.
constexpr std::size_t kLongest = 4096;

}  // namespace

std::string command_text(const process::CommandRecord& record, const process::Outcome& outcome,
                         canopen::TimePoint now) {
  const std::string head = "{\"ts\":\"" + text::timestamp(record.wall) + "\"," + journal::who_text(record) +
                           ",\"outcome\":\"" + journal::code_of(outcome) + '"';
  std::string all = head + ',' + journal::what_text(record) + ',' + journal::result_text(record, outcome, now) + '}';
  return all.size() <= kLongest ? all : head + ",\"too_long\":true}";
}

void CommandTrail::add(std::string text, canopen::TimePoint now, canopen::TimePoint wanted_from) {
  while (!commands_.empty() && commands_.front().at < wanted_from) {
    commands_.pop_front();
  }
  if (commands_.size() >= kMost) {
    left_out_.push_back(commands_.front().at);
    commands_.pop_front();
  }
  while (!left_out_.empty() && (left_out_.front() < wanted_from || left_out_.size() > kMost)) {
    left_out_.pop_front();
  }
  commands_.push_back({now, std::move(text)});
}

CommandTrail::Taken CommandTrail::since(canopen::TimePoint from) const {
  Taken taken;
  for (const canopen::TimePoint& at : left_out_) {
    taken.left_out += at >= from ? 1U : 0U;
  }
  for (const Answered& command : commands_) {
    if (command.at >= from) {
      taken.commands.push_back(command.text);
    }
  }
  return taken;
}

}  // namespace recorder
