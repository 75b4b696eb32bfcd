#include "canopen/node/configure.h"

#include <array>
#include <utility>

#include "canopen/communication_objects.h"
#include "canopen/node/error_control_setup.h"
#include "canopen/node/life_guarding.h"
#include "canopen/node/motor_check.h"
#include "canopen/node/node_guarding.h"
#include "canopen/node/pdo_setup.h"
#include "canopen/node/read_life_guarding.h"
#include "canopen/node/setup_session.h"
#include "canopen/sdo/client.h"

namespace canopen {
namespace {

using Failure = std::optional<BootFailure>;

/// One configuration or inspection under way.
struct Procedure {
  SetupSession session;
  TimePoint heartbeat_from;  ///< A heartbeat counts from then on: later where its time was written.
  BootReport report{};
};

void note(BootReport& report, const BootFailure& failure) {
  report.interrupted = failure.interrupted;
  report.letter = failure.interrupted ? BootResult::ok : failure.letter;
  report.text = failure.text;
  report.cause = failure.cause;
}

using ErrorControlStep = boost::asio::awaitable<ErrorControlOutcome> (*)(SetupSession&, std::vector<std::string>&);

struct IdentityItem {
  BootResult letter = BootResult::other_device_type;
  ObjectAddress object;
  const char* name = "";
  std::optional<std::uint32_t> wanted;
};

/// A node that cannot show what is expected of it is not the expected one.
boost::asio::awaitable<Failure> check_identity(SetupSession& session, const ExpectedIdentity& expected) {
  const std::array items{
      IdentityItem{BootResult::other_device_type, kDeviceType, "device type", expected.device_type},
      IdentityItem{BootResult::other_vendor, {0x1018, 1}, "vendor id", expected.vendor},
      IdentityItem{BootResult::other_product, {0x1018, 2}, "product code", expected.product},
      IdentityItem{BootResult::other_revision, {0x1018, 3}, "revision number", expected.revision},
      IdentityItem{BootResult::other_serial_number, kSerialNumber, "serial number", expected.serial},
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

boost::asio::awaitable<Failure> set_up(Procedure& procedure, SetupItem item) {
  SetupOutcome outcome = co_await procedure.session.ensure(std::move(item));
  if (!outcome.remark.empty()) {
    procedure.report.remarks.push_back(std::move(outcome.remark));
  }
  co_return std::move(outcome.failure);
}

boost::asio::awaitable<Failure> set_up(Procedure& procedure, ErrorControlStep step) {
  const TimePoint begun = Clock::now();
  ErrorControlOutcome outcome = co_await step(procedure.session, procedure.report.remarks);
  if (outcome.heartbeat_written) {
    procedure.heartbeat_from = begun;
  }
  procedure.report.error_control = outcome.kind;
  procedure.report.heartbeat_as_wanted = outcome.heartbeat_as_wanted;
  co_return std::move(outcome.failure);
}

boost::asio::awaitable<Failure> set_up_pdos(Procedure& procedure, PdoRole role, const std::vector<PdoSettings>& pdos) {
  for (const PdoSettings& pdo : pdos) {
    PdoSetupOutcome outcome = co_await set_up_pdo(procedure.session, role, pdo);
    if (outcome.failure) {
      co_return std::move(outcome.failure);
    }
    const bool transmit = role == PdoRole::transmit;
    if (transmit && outcome.timing_confirmed) {
      procedure.report.verified_tpdos.push_back(pdo.number);
    }
    procedure.report.remarks.insert(procedure.report.remarks.end(), outcome.remarks.begin(), outcome.remarks.end());
    if (outcome.absent) {
      procedure.report.remarks.push_back(
          std::string(transmit ? "TPDO" : "RPDO") + std::to_string(pdo.number) +
          ": the drive has no communication or mapping object; its documented default is assumed");
    }
  }
  co_return std::nullopt;
}

boost::asio::awaitable<Failure> set_up_further(Procedure& procedure, const std::vector<ObjectValue>& setup) {
  for (const ObjectValue& value : setup) {
    SetupItem item{value.object, value.type, value.raw, "setting", SetupPolicy::write};
    Failure failure = co_await set_up(procedure, std::move(item));
    if (failure) {
      co_return failure;
    }
  }
  co_return std::nullopt;
}

boost::asio::awaitable<Failure> await_heartbeat(const Procedure& procedure) {
  const LifeContext& context = procedure.session.context();
  Failure failure;
  const bool alive = co_await heartbeat_after(context, procedure.heartbeat_from);
  const ErrorControlSettings& control = context.settings.error_control;
  if (context.life.over()) {
    failure = BootFailure{.interrupted = true};
  } else if (!alive && procedure.report.error_control == ErrorControlKind::guarding) {
    failure = BootFailure{BootResult::no_guarding, no_guarding_text(context), false};
  } else if (!alive) {
    failure =
        BootFailure{BootResult::no_heartbeat,
                    "no heartbeat within " + std::to_string(whole_ms(control.heartbeat_timeout)) +
                        " ms, although 0x1017:00 should be " + std::to_string(whole_ms(control.heartbeat)) + " ms"};
  }
  co_return failure;
}

/// Before the first write to a node of unknown state: error control that will tell it, or a motor that stands.
boost::asio::awaitable<Failure> learn_before_writing(Procedure& procedure) {
  const LifeContext& context = procedure.session.context();
  Failure failure = co_await check_identity(procedure.session, context.settings.identity);
  if (failure) {
    co_return failure;
  }
  const ErrorControlSettings& control = context.settings.error_control;
  const Result<LifeGuarding> guarded = co_await read_life_guarding(context.sdo);
  const bool guarding_off = guarded.has_value() && guarded.value().unset();
  if (guarding_off && kind_of(control) == ErrorControlKind::heartbeat && control.policy == SetupPolicy::write) {
    procedure.session.note_half_done(false);  // Its heartbeat alone is no configuration.
    failure = co_await set_up(procedure, set_up_heartbeat);
    procedure.session.note_half_done(true);
    if (!failure) {
      failure = co_await await_heartbeat(procedure);
    }
    co_return failure;
  }
  const std::optional<bool> running = co_await read_running(context.sdo, context.settings.motor);
  if (context.life.over()) {
    failure = BootFailure{.interrupted = true};
  } else if (running != false) {
    failure =
        BootFailure{BootResult::left_alone, std::string("nothing tells whether it is operational, and ") +
                                                (running ? "its motor runs" : "whether its motor runs cannot be read") +
                                                "; it is left as it is until its boot-up"};
  }
  co_return failure;
}

/// Identity, error control, PDOs, further settings, which may change 0x1014, and that; in the session's purpose.
boost::asio::awaitable<Failure> go_through(Procedure& procedure) {
  const NodeSettings& settings = procedure.session.context().settings;
  Failure failure = co_await check_identity(procedure.session, settings.identity);
  if (!failure) {
    failure = co_await set_up(procedure, set_up_error_control);
  }
  if (!failure) {
    failure = co_await set_up_pdos(procedure, PdoRole::transmit, settings.tpdos);
  }
  if (!failure) {
    failure = co_await set_up_pdos(procedure, PdoRole::receive, settings.rpdos);
  }
  if (!failure) {
    failure = co_await set_up_further(procedure, settings.setup);
  }
  if (!failure) {
    procedure.report.emcy = co_await set_up_emcy(procedure.session, procedure.report.remarks);
  }
  co_return failure;
}

}  // namespace

std::string no_guarding_text(const LifeContext& context) {
  const auto timeout =
      std::chrono::duration_cast<std::chrono::milliseconds>(context.settings.error_control.heartbeat_timeout);
  const std::string within = " within " + std::to_string(timeout.count()) + " ms";
  if (context.guarding.answered()) {
    return "no two guarding answers with alternating toggle bits" + within + "; such answers do not count";
  }
  return "no guarding answer" + within;
}

boost::asio::awaitable<BootReport> inspect(LifeContext context) {
  Procedure procedure{{context, SetupPurpose::inspect}, {}};
  const Failure failure = co_await go_through(procedure);
  if (failure) {
    note(procedure.report, *failure);
  }
  co_return std::move(procedure.report);
}

boost::asio::awaitable<BootReport> configure(LifeContext context, FoundState found) {
  Procedure procedure{{context, SetupPurpose::configure},
                      Clock::now() - context.settings.error_control.heartbeat_timeout};
  Failure failure;
  if (found == FoundState::unknown) {
    failure = co_await learn_before_writing(procedure);
  }
  if (!failure) {
    failure = co_await go_through(procedure);
  }
  if (!failure && procedure.report.error_control != ErrorControlKind::none) {
    failure = co_await await_heartbeat(procedure);
  }
  if (failure) {
    note(procedure.report, *failure);
  }
  co_return std::move(procedure.report);
}

}  // namespace canopen
