// When an error is over: a row for each sentence of docs/ALARMS.md, and for what they make together.

#include "bridges/alarms/error_decision.h"

#include <gtest/gtest.h>

#include <array>
#include <string_view>
#include <vector>

namespace alarms {
namespace {

using Register = RegisterWitness;
constexpr Register kNotRead{};
constexpr Register kAbsent{.state = Register::State::absent};
constexpr Register kIndependent{.state = Register::State::independent};
constexpr Register reads(std::uint8_t value) {
  return {.state = Register::State::read, .value = value};
}

enum class Seen : std::uint8_t { nothing, set, clear_long };  ///< Of the signal, after the error was told.
enum class Kind : std::uint8_t { plain, communication };      ///< 0x2310, 0x8130
enum class Beside : std::uint8_t { nothing, communication };  ///< Another error.
constexpr auto kActive = ErrorVerdict::active;
constexpr auto kUndecided = ErrorVerdict::undecided;
constexpr auto kOver = ErrorVerdict::over;
constexpr auto kEmcy = ErrorSource::emergency;

struct Row {
  std::string_view text;
  ErrorSource source;
  Kind kind;
  ErrorSignal signal;
  Seen seen;
  Register error_register;
  Beside beside;
  ErrorVerdict verdict;
};

ErrorFacts facts_of(const Row& row) {
  return {.source = row.source,
          .communication = row.kind == Kind::communication,
          .reset = {},
          .signal = row.signal,
          .seen_set = row.seen == Seen::set,
          .clear_three_periods = row.seen == Seen::clear_long,
          .error_register = row.error_register,
          .other_communication = row.beside == Beside::communication};
}

void expect_rows(const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    EXPECT_EQ(decide(facts_of(row)), row.verdict) << row.text;
  }
}

TEST(ErrorDecision, AnErrorOfADriveWithoutSuchASignalEndsByTheErrorRegister) {
  using enum ErrorSignal;
  expect_rows({
      {"not read", kEmcy, Kind::plain, none, Seen::nothing, kNotRead, Beside::nothing, kUndecided},
      {"still set", kEmcy, Kind::plain, none, Seen::nothing, reads(0x01), Beside::nothing, kUndecided},
      {"0", kEmcy, Kind::plain, none, Seen::nothing, reads(0), Beside::nothing, kOver},
      {"only an emergency can tell", kEmcy, Kind::plain, none, Seen::nothing, kAbsent, Beside::nothing, kActive},
      {"likewise", kEmcy, Kind::plain, none, Seen::nothing, kIndependent, Beside::nothing, kActive},
      {"bits 0 and 4", kEmcy, Kind::plain, none, Seen::nothing, reads(0x11), Beside::communication, kUndecided},
      {"0x8130", kEmcy, Kind::communication, none, Seen::nothing, reads(0x11), Beside::nothing, kUndecided},
      {"0x8130, 0", kEmcy, Kind::communication, none, Seen::nothing, reads(0), Beside::nothing, kOver},
      {"signal not received", kEmcy, Kind::plain, unknown, Seen::nothing, kNotRead, Beside::nothing, kUndecided},
      {"likewise, 0", kEmcy, Kind::plain, unknown, Seen::nothing, reads(0), Beside::nothing, kOver},
      {"nor a register", kEmcy, Kind::plain, unknown, Seen::nothing, kAbsent, Beside::nothing, kActive},
      {"was set, then lost", kEmcy, Kind::plain, unknown, Seen::set, kAbsent, Beside::nothing, kActive},
      {"memory", ErrorSource::memory, Kind::plain, none, Seen::nothing, kNotRead, Beside::nothing, kUndecided},
      {"found", ErrorSource::error_register, Kind::plain, none, Seen::nothing, reads(1), Beside::nothing, kUndecided},
      {"found, 0", ErrorSource::error_register, Kind::plain, none, Seen::nothing, reads(0), Beside::nothing, kOver},
  });
}

TEST(ErrorDecision, ASignalThatIsSetHoldsAnError) {
  using enum ErrorSignal;
  expect_rows({
      {"plain", kEmcy, Kind::plain, set, Seen::set, kNotRead, Beside::nothing, kActive},
      {"it would only come back", kEmcy, Kind::plain, set, Seen::set, reads(0), Beside::nothing, kActive},
      {"set since before the emergency", kEmcy, Kind::plain, set, Seen::nothing, reads(0), Beside::nothing, kActive},
      {"0x8130 too", kEmcy, Kind::communication, set, Seen::set, reads(0), Beside::nothing, kActive},
      {"no register", kEmcy, Kind::plain, set, Seen::set, kAbsent, Beside::nothing, kActive},
      {"bits 0 and 4", kEmcy, Kind::plain, set, Seen::set, reads(0x11), Beside::communication, kActive},
      {"memory", ErrorSource::memory, Kind::plain, set, Seen::set, reads(0), Beside::nothing, kActive},
  });
}

TEST(ErrorDecision, ASignalThatWentClearEndsAnErrorWhereTheErrorRegisterAgrees) {
  using enum ErrorSignal;
  for (const Seen seen : {Seen::set, Seen::clear_long}) {
    for (const ErrorSource source : {kEmcy, ErrorSource::signal, ErrorSource::error_register, ErrorSource::memory}) {
      expect_rows({
          {"not read since", source, Kind::plain, clear, seen, kNotRead, Beside::nothing, kUndecided},
          {"0", source, Kind::plain, clear, seen, reads(0), Beside::nothing, kOver},
          {"generic", source, Kind::plain, clear, seen, reads(0x01), Beside::nothing, kUndecided},
          {"communication", source, Kind::plain, clear, seen, reads(0x11), Beside::nothing, kUndecided},
          {"explained", source, Kind::plain, clear, seen, reads(0x11), Beside::communication, kOver},
          {"explained, bit 0", source, Kind::plain, clear, seen, reads(0x01), Beside::communication, kOver},
          {"explained, bit 4", source, Kind::plain, clear, seen, reads(0x10), Beside::communication, kOver},
          {"current", source, Kind::plain, clear, seen, reads(0x13), Beside::communication, kUndecided},
          {"absent", source, Kind::plain, clear, seen, kAbsent, Beside::nothing, kOver},
          {"error_register = false", source, Kind::plain, clear, seen, kIndependent, Beside::nothing, kOver},
      });
    }
  }
}

TEST(ErrorDecision, ASignalThatIsClearOnlyNowTellsNothingYet) {
  using enum ErrorSignal;
  expect_rows({
      {"may follow", kEmcy, Kind::plain, clear, Seen::nothing, kNotRead, Beside::nothing, kActive},
      {"register set", kEmcy, Kind::plain, clear, Seen::nothing, reads(0x01), Beside::nothing, kActive},
      {"explained", kEmcy, Kind::plain, clear, Seen::nothing, reads(0x11), Beside::communication, kActive},
      {"absent", kEmcy, Kind::plain, clear, Seen::nothing, kAbsent, Beside::nothing, kActive},
      {"independent", kEmcy, Kind::plain, clear, Seen::nothing, kIndependent, Beside::nothing, kActive},
      {"but 0 ends it", kEmcy, Kind::plain, clear, Seen::nothing, reads(0), Beside::nothing, kOver},
  });
}

TEST(ErrorDecision, NoSignalEndsACommunicationError) {
  using enum ErrorSignal;
  for (const Seen seen : {Seen::nothing, Seen::set, Seen::clear_long}) {
    for (const ErrorSource source : {kEmcy, ErrorSource::memory}) {
      expect_rows({
          {"not read", source, Kind::communication, clear, seen, kNotRead, Beside::nothing, kUndecided},
          {"latched", source, Kind::communication, clear, seen, reads(0x11), Beside::nothing, kUndecided},
          {"two", source, Kind::communication, clear, seen, reads(0x11), Beside::communication, kUndecided},
          {"0", source, Kind::communication, clear, seen, reads(0), Beside::nothing, kOver},
          {"absent", source, Kind::communication, clear, seen, kAbsent, Beside::nothing, kActive},
          {"independent", source, Kind::communication, clear, seen, kIndependent, Beside::nothing, kActive},
      });
    }
  }
}

TEST(ErrorDecision, WhatTheSignalItselfToldEndsWithIt) {
  using enum ErrorSignal;
  constexpr auto kSignal = ErrorSource::signal;
  expect_rows({
      {"whatever its code", kSignal, Kind::communication, clear, Seen::set, kAbsent, Beside::nothing, kOver},
      {"register set", kSignal, Kind::communication, clear, Seen::set, reads(0x11), Beside::nothing, kUndecided},
      {"0", kSignal, Kind::communication, clear, Seen::set, reads(0), Beside::nothing, kOver},
  });
}

struct ResetRow {
  std::string_view text;
  ErrorReset reset;
  bool all_clear;
};

constexpr std::array kResets{
    ResetRow{"CiA 301", {0, 0}, true},
    ResetRow{"Lenze: partial", {0x08, 0}, false},
    ResetRow{"OPTE6: one remains", {0, 1}, false},
    ResetRow{"OPTE6: one remains, register set", {0x81, 1}, false},
    ResetRow{"OPTE6: none remains, register set", {0x81, 0}, false},
};

TEST(ErrorDecision, AResetThatLeavesNothingEndsEveryError) {
  for (const ResetRow& row : kResets) {
    EXPECT_EQ(is_all_clear(row.reset), row.all_clear) << row.text;
    for (const ErrorSignal signal : {ErrorSignal::none, ErrorSignal::unknown, ErrorSignal::set, ErrorSignal::clear}) {
      for (const bool communication : {false, true}) {
        for (const Register& error_register : {kNotRead, kAbsent, kIndependent, reads(0x11)}) {
          ErrorFacts facts{
              .communication = communication, .reset = {}, .signal = signal, .error_register = error_register};
          const ErrorVerdict without = decide(facts);
          facts.reset = row.reset;
          EXPECT_EQ(decide(facts), row.all_clear ? kOver : without) << row.text;
          EXPECT_NE(without, kOver);
        }
      }
    }
  }
}

}  // namespace
}  // namespace alarms
