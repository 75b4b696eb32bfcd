#include "canopen/node/consumer_setup.h"

#include <algorithm>
#include <utility>

#include "canopen/communication_objects.h"
#include "canopen/node/consumer_table.h"
#include "canopen/node/error_control_setup.h"

namespace canopen {
namespace {

constexpr const char* kConsumerName = "consumer heartbeat time";

struct ConsumerTable {
  std::optional<BootFailure> failure;
  std::vector<ConsumerEntry> entries;  ///< Empty: it does not say how many it has.
};

boost::asio::awaitable<ConsumerTable> read_consumer_table(SetupSession& session) {
  ConsumerTable table;
  const Result<Raw> count = co_await session.read({kConsumerHeartbeat.index, 0}, DataType::u8);
  if (count.has_error()) {
    if (!is_absent(count.error())) {
      table.failure = session.failure(count.error(), kConsumerName);
    }
    co_return table;
  }
  for (Raw sub = 1; sub <= count.value() && !table.failure; ++sub) {
    const ObjectAddress object{kConsumerHeartbeat.index, static_cast<std::uint8_t>(sub)};
    const Result<Raw> value = co_await session.read(object, DataType::u32);
    if (value.has_value()) {
      table.entries.push_back({object.sub, value.value()});
    } else if (!is_absent(value.error())) {
      table.failure = session.failure(value.error(), kConsumerName);
    }
  }
  co_return table;
}

SetupItem consumer_item(std::uint8_t sub, Raw value) {
  SetupItem item{{kConsumerHeartbeat.index, sub}, DataType::u32, value, kConsumerName, SetupPolicy::write};
  item.mask = kConsumerUsed;
  return item;
}

/// Some keep that time in steps of their own, or clamp it. Later than wanted it may not trip, and sooner only by so
/// much that one late heartbeat of ours does not trip it.
void allow_sooner(SetupItem& entry, const NodeSettings& settings) {
  const Raw wanted = whole_ms(settings.error_control.supervise_gateway);
  const Raw least = std::max(wanted - wanted / 4, 2 * whole_ms(settings.gateway_heartbeat));
  if (least < wanted) {
    entry.least = entry.wanted - (wanted - least);
    entry.most = entry.wanted;
  }
}

std::string short_entry_text(ConsumerEntry entry, const NodeSettings& settings) {
  return to_string(ObjectAddress{kConsumerHeartbeat.index, entry.sub}) +
         " has the gateway's node id: the drive trips when our heartbeat is missing for " +
         std::to_string(consumer_time(entry.value)) + " ms, and it comes each " +
         std::to_string(whole_ms(settings.gateway_heartbeat)) + " ms";
}

/// Never kept by our heartbeat.
boost::asio::awaitable<std::string> clear_entry(SetupSession& session, std::uint8_t sub) {
  SetupItem item = consumer_item(sub, 0);
  const SetupOutcome outcome = co_await session.ensure(std::move(item));
  co_return outcome.failure ? "; it cannot be cleared: " + outcome.failure->text
                            : std::string("; left by another master, it was cleared");
}

}  // namespace

boost::asio::awaitable<std::optional<BootFailure>> set_up_consumer(SetupSession& session,
                                                                   std::vector<std::string>& remarks) {
  const NodeSettings& settings = session.context().settings;
  const Raw wanted = consumer_value(settings.gateway_node, whole_ms(settings.error_control.supervise_gateway));
  ConsumerTable table = co_await read_consumer_table(session);
  if (table.failure) {
    co_return std::move(table.failure);
  }
  if (table.entries.empty()) {
    table.entries.push_back({kConsumerHeartbeat.sub, 0});
  }
  const auto plan = plan_consumer_table(table.entries, wanted);
  if (!plan) {
    co_return session.difference("0x1016 " + std::string(kConsumerName) + ": each of its " +
                                 std::to_string(table.entries.size()) +
                                 " entries watches over another node, none is left for the gateway");
  }
  for (const ConsumerEntry& planned : *plan) {
    SetupItem entry = consumer_item(planned.sub, planned.value);
    if (planned.value == wanted) {
      allow_sooner(entry, settings);
    }
    SetupOutcome outcome = co_await session.ensure(std::move(entry));
    if (!outcome.remark.empty()) {
      remarks.push_back(std::move(outcome.remark));
    }
    if (outcome.failure) {
      co_return std::move(outcome.failure);
    }
  }
  co_return std::nullopt;
}

boost::asio::awaitable<void> look_at_consumers(SetupSession& session, std::vector<std::string>& remarks) {
  const NodeSettings& settings = session.context().settings;
  const Raw heartbeat = whole_ms(settings.gateway_heartbeat);
  if (settings.gateway_node == 0 || heartbeat == 0) {
    co_return;
  }
  const ConsumerTable table = co_await read_consumer_table(session);
  for (const ConsumerEntry& entry : table.entries) {
    const Raw time = consumer_time(entry.value);
    if (consumer_node(entry.value) != settings.gateway_node || time == 0 || time >= 2 * heartbeat) {
      continue;
    }
    std::string remark = short_entry_text(entry, settings);
    if (time <= heartbeat && !session.inspecting()) {
      remark += co_await clear_entry(session, entry.sub);
    } else {
      remark += "; clear it, or set supervise_gateway";
    }
    if (session.context().life.over()) {
      co_return;
    }
    remarks.push_back(std::move(remark));
  }
}

}  // namespace canopen
