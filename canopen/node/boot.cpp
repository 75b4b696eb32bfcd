#include "canopen/node/boot.h"

#include <algorithm>
#include <array>
#include <utility>

#include "canopen/hex.h"
#include "canopen/node/pdo_setup.h"
#include "canopen/sdo/client.h"

namespace canopen {
namespace {

constexpr ObjectAddress kDeviceType{0x1000, 0};
constexpr ObjectAddress kConsumerHeartbeat{0x1016, 1};
constexpr ObjectAddress kProducerHeartbeat{0x1017, 0};

using Failure = std::optional<BootFailure>;

Raw milliseconds(Duration duration) noexcept {
  return static_cast<Raw>(std::chrono::duration_cast<std::chrono::milliseconds>(duration).count());
}

void note_failure(BootReport& report, const BootFailure& failure) {
  report.interrupted = failure.interrupted;
  report.letter = failure.interrupted ? kBootOk : static_cast<std::uint8_t>(failure.letter);
  report.text = failure.text;
}

struct IdentityItem {
  char letter = 'C';
  ObjectAddress object;
  const char* name = "";
  std::optional<std::uint32_t> wanted;
};

/// Letters B, C, D, M, N, O. A node that cannot show what is expected of it is not the expected one.
boost::asio::awaitable<Failure> check_identity(SetupSession& session, const ExpectedIdentity& expected) {
  const std::array items{
      IdentityItem{'C', kDeviceType, "device type", expected.device_type},
      IdentityItem{'D', {0x1018, 1}, "vendor id", expected.vendor},
      IdentityItem{'M', {0x1018, 2}, "product code", expected.product},
      IdentityItem{'N', {0x1018, 3}, "revision number", expected.revision},
      IdentityItem{'O', {0x1018, 4}, "serial number", expected.serial},
  };
  Failure failure;
  for (const IdentityItem& item : items) {
    if (!item.wanted) {
      continue;
    }
    const Result<Raw> found = co_await session.read(item.object, DataType::u32);
    if (found.has_error()) {
      failure = session.failure(found.error(), item.name);
      if (found.error().kind == ErrorKind::refused) {
        failure->letter = item.letter;
      }
      co_return failure;
    }
    if (found.value() != *item.wanted) {
      const SetupItem shown{item.object, DataType::u32, *item.wanted, item.name, SetupPolicy::verify};
      failure = BootFailure{item.letter, difference_text(shown, found.value()), false};
      co_return failure;
    }
  }
  co_return failure;
}

boost::asio::awaitable<Failure> set_up(SetupSession& session, SetupItem item, BootReport& report) {
  const std::string name = to_string(item.object) + " " + item.name;
  SetupOutcome outcome = co_await session.ensure(std::move(item));
  if (outcome.absent) {
    report.remarks.push_back(name + " does not exist in the drive");
  }
  co_return std::move(outcome.failure);
}

/// 0x1017, and 0x1016 where the drive is to watch over us.
boost::asio::awaitable<Failure> set_up_error_control(SetupSession& session, const NodeSettings& settings,
                                                     BootReport& report, bool& written) {
  const ErrorControlSettings& control = settings.error_control;
  SetupItem producer{kProducerHeartbeat, DataType::u16, milliseconds(control.heartbeat), "heartbeat time",
                     control.policy};
  SetupOutcome outcome = co_await session.ensure(std::move(producer));
  written = outcome.written;
  if (outcome.absent) {
    report.remarks.push_back(to_string(kProducerHeartbeat) + " heartbeat time does not exist in the drive");
  }
  if (outcome.failure || control.supervise_gateway <= Duration::zero() || settings.gateway_node == 0) {
    co_return std::move(outcome.failure);
  }
  // CiA 301 §7.5.2.17: node id in bits 16..23, time in bits 0..15.
  const Raw watched = (Raw{settings.gateway_node} << 16U) | milliseconds(control.supervise_gateway);
  SetupItem consumer{kConsumerHeartbeat, DataType::u32, watched, "consumer heartbeat time", SetupPolicy::write};
  co_return co_await set_up(session, std::move(consumer), report);
}

boost::asio::awaitable<Failure> set_up_pdos(SetupSession& session, PdoRole role, const std::vector<PdoSettings>& pdos,
                                            BootReport& report) {
  for (const PdoSettings& pdo : pdos) {
    PdoSetupOutcome outcome = co_await set_up_pdo(session, role, pdo);
    if (outcome.failure) {
      co_return std::move(outcome.failure);
    }
    const bool transmit = role == PdoRole::transmit;
    if (transmit && outcome.timing_confirmed) {
      report.verified_tpdos.push_back(pdo.number);
    }
    if (outcome.absent) {
      report.remarks.push_back(std::string(transmit ? "TPDO" : "RPDO") + std::to_string(pdo.number) +
                               ": the drive has no communication or mapping object; its documented default is assumed");
    }
  }
  co_return std::nullopt;
}

boost::asio::awaitable<Failure> set_up_further(SetupSession& session, const std::vector<ObjectValue>& setup,
                                               BootReport& report) {
  for (const ObjectValue& value : setup) {
    SetupItem item{value.object, value.type, value.raw, "setting", SetupPolicy::write};
    Failure failure = co_await set_up(session, std::move(item), report);
    if (failure) {
      co_return failure;
    }
  }
  co_return std::nullopt;
}

std::string no_heartbeat_text(const ErrorControlSettings& control) {
  return "no heartbeat within " + std::to_string(milliseconds(control.heartbeat_timeout)) +
         " ms, although 0x1017:00 should be " + std::to_string(milliseconds(control.heartbeat)) + " ms";
}

}  // namespace

bool expects_heartbeat(const NodeSettings& settings) noexcept {
  return settings.error_control.heartbeat > Duration::zero() &&
         settings.error_control.heartbeat_timeout > Duration::zero();
}

boost::asio::awaitable<BootReport> check_settings(SetupSession& session, const NodeSettings& settings,
                                                  bool& error_control_written) {
  BootReport report;
  Failure failure = co_await check_identity(session, settings.identity);
  if (!failure) {
    failure = co_await set_up_error_control(session, settings, report, error_control_written);
  }
  if (!failure) {
    failure = co_await set_up_pdos(session, PdoRole::transmit, settings.tpdos, report);
  }
  if (!failure) {
    failure = co_await set_up_pdos(session, PdoRole::receive, settings.rpdos, report);
  }
  if (!failure) {
    failure = co_await set_up_further(session, settings.setup, report);
  }
  if (failure) {
    note_failure(report, *failure);
  }
  co_return report;
}

boost::asio::awaitable<BootReport> boot(SdoClient& sdo, const NodeSettings& settings, NmtLine& line) {
  SetupSession session(sdo, SetupPurpose::configure);
  const TimePoint begun = Clock::now();
  bool error_control_written = false;
  BootReport report = co_await check_settings(session, settings, error_control_written);
  if (!report.ok()) {
    co_return report;
  }
  if (expects_heartbeat(settings)) {
    // A heartbeat from before counts only where its time was left as it is.
    const Duration before = error_control_written ? Duration::zero() : settings.error_control.heartbeat_timeout;
    const bool alive = co_await line.heartbeat_after(begun - before);
    if (session.interrupted()) {
      report.interrupted = true;
      co_return report;
    }
    if (!alive) {
      note_failure(report, {'K', no_heartbeat_text(settings.error_control), false});
      co_return report;
    }
  }
  line.settings_done(report);
  if (line.may_start()) {
    const Failure failure = co_await line.start_node();
    if (failure) {
      note_failure(report, *failure);
    }
  }
  co_return report;
}

}  // namespace canopen
