#include "canopen/node/emcy_setup.h"

#include "canopen/communication_objects.h"
#include "canopen/hex.h"
#include "canopen/node/setup_session.h"

namespace canopen {
namespace {

// CiA 301 §7.5.2.17: bit 31 set, the EMCY does not exist; bit 30 is reserved.
constexpr Raw kOff = 0x80000000;
constexpr Raw kReserved = 0x40000000;

std::string value_text(Raw value) {
  return "0x" + hex(value, 8);
}

EmcyVerdict verdict_of(Raw found, Raw wanted) {
  const std::string object = to_string(kEmcyCobId) + " is " + value_text(found);
  if ((found & kOff) != 0) {
    return {EmcyService::off, "emergencies are switched off in the drive: " + object};
  }
  if ((found & ~kReserved) != wanted) {
    return {EmcyService::moved, "emergencies come under another COB-ID and are not received: " + object +
                                    ", expected " + value_text(wanted)};
  }
  return {};
}

/// The COB-ID of an EMCY that exists may not be changed (CiA 301 §7.5.2.17): it is switched off first.
boost::asio::awaitable<Result<void>> write(SetupSession& session, Raw found, Raw wanted) {
  const bool exists = (found & kOff) == 0;
  if (exists) {
    const Result<void> off = co_await session.write(kEmcyCobId, DataType::u32, found | kOff);
    if (off.has_error()) {
      co_return off;
    }
  }
  const Result<void> written = co_await session.write(kEmcyCobId, DataType::u32, wanted);
  if (written.has_error() && exists) {
    // Whoever hears them where they are still shall.
    static_cast<void>(co_await session.write(kEmcyCobId, DataType::u32, found));
  }
  co_return written;
}

}  // namespace

boost::asio::awaitable<std::optional<EmcyVerdict>> set_up_emcy(SetupSession& session,
                                                               std::vector<std::string>& remarks) {
  const NodeSettings& settings = session.context().settings;
  const Raw wanted = Raw{0x80} + settings.node;
  const Result<Raw> found = co_await session.read(kEmcyCobId, DataType::u32);
  if (found.has_error()) {
    co_return found.error().kind == ErrorKind::refused ? std::optional(EmcyVerdict{}) : std::nullopt;
  }
  EmcyVerdict verdict = verdict_of(found.value(), wanted);
  if (verdict.service == EmcyService::as_expected || !settings.emcy.enable || session.inspecting()) {
    co_return verdict;
  }
  const Result<void> written = co_await write(session, found.value(), wanted);
  const Result<Raw> back = co_await session.read(kEmcyCobId, DataType::u32);
  if (back.has_value()) {
    verdict = verdict_of(back.value(), wanted);
  }
  if (back.has_value() && verdict.service == EmcyService::as_expected) {
    remarks.push_back(to_string(kEmcyCobId) + " EMCY was " + value_text(found.value()) + " and is " +
                      value_text(back.value()) + " now: emergencies are received");
  } else if (written.has_error()) {
    verdict.text += "; writing it failed: " + to_string(written.error());
  } else {
    verdict.text += back.has_value() ? " after it was written"
                                     : "; it was written, but reading it back failed: " + to_string(back.error());
  }
  co_return verdict;
}

}  // namespace canopen
