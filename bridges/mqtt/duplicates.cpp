#include "bridges/mqtt/duplicates.h"

#include <algorithm>
#include <array>
#include <utility>

namespace mqtt {
namespace {

// Length before text, so that no two commands make one key.
void append_part(std::string& key, std::string_view part) {
  key += std::to_string(part.size());
  key += ':';
  key += part;
}

std::string key_of(const Incoming& command) {
  std::string key;
  append_part(key, command.topic);
  append_part(key, command.payload);
  append_part(key, command.response_topic);
  append_part(key, command.correlation.value_or(""));
  return key;
}

}  // namespace

std::optional<Duplicates::Earlier> Duplicates::earlier(const Incoming& command, bool has_id, canopen::TimePoint now) {
  forget_old(now);
  const bool may_be_told = has_id || command.correlation.has_value() || command.redelivered;
  const auto found = may_be_told ? entries_.find(key_of(command)) : entries_.end();
  if (found == entries_.end()) {
    return std::nullopt;
  }
  return Earlier{found->second.ticket, found->second.first};
}

Duplicates::Ticket Duplicates::remember(const Incoming& command, canopen::TimePoint now) {
  forget_old(now);
  const auto [place, added] = entries_.try_emplace(key_of(command));
  Entry& entry = place->second;
  if (added) {
    bytes_ += place->first.size();
  } else {
    by_age_.erase(entry.ticket);
    bytes_ -= entry.first ? entry.first->size() : 0;
  }
  entry = {.ticket = ++last_, .at = now};
  by_age_.emplace(entry.ticket, &*place);
  limit();
  return last_;
}

void Duplicates::settle(Ticket ticket, std::string first) {
  const auto found = by_age_.find(ticket);
  if (found == by_age_.end()) {
    return;
  }
  Entry& entry = found->second->second;
  bytes_ += first.size();
  bytes_ -= entry.first ? entry.first->size() : 0;
  entry.first = std::move(first);
  limit();
}

void Duplicates::forget(Ticket ticket) {
  const auto found = by_age_.find(ticket);
  if (found == by_age_.end()) {
    return;
  }
  const auto entry = entries_.find(found->second->first);
  bytes_ -= entry->first.size() + (entry->second.first ? entry->second.first->size() : 0);
  entries_.erase(entry);
  by_age_.erase(found);
}

void Duplicates::forget_old(canopen::TimePoint now) {
  while (!by_age_.empty() && now - by_age_.begin()->second->second.at >= kMemory) {
    forget(by_age_.begin()->first);
  }
}

void Duplicates::limit() {
  while (bytes_ > kCapacity) {
    forget(by_age_.begin()->first);
  }
}

bool may_come_again(const process::Outcome& outcome) noexcept {
  using canopen::ErrorKind;
  constexpr std::array kMayComeAgain{ErrorKind::forbidden, ErrorKind::offline, ErrorKind::lease,
                                     ErrorKind::range,     ErrorKind::type,    ErrorKind::incomplete};
  if (outcome.has_value() || outcome.written != 0) {
    return false;
  }
  // An abort is the drive's answer to something that was sent.
  const canopen::Error& error = *outcome.failure;
  return !error.outcome_unknown && error.abort == 0 &&
         std::ranges::find(kMayComeAgain, error.kind) != kMayComeAgain.end();
}

}  // namespace mqtt
