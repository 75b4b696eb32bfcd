#include "canopen/node/pdo_setup.h"

#include <utility>
#include <vector>

#include "canopen/hex.h"

namespace canopen {
namespace {

constexpr std::uint16_t kRpdoCommunication = 0x1400;
constexpr std::uint16_t kTpdoCommunication = 0x1800;
constexpr std::uint16_t kMappingOffset = 0x200;  // 0x1600 and 0x1A00.
constexpr std::uint8_t kCobId = 1;
constexpr std::uint8_t kTransmissionType = 2;
constexpr std::uint8_t kInhibitTime = 3;
constexpr std::uint8_t kEventTimer = 5;

constexpr Raw kIdentifier = 0x1FFF'FFFF;
constexpr Raw kInvalid = 0x8000'0000;       // Bit 31: the PDO does not exist.
constexpr Raw kRtrForbidden = 0x4000'0000;  // Bit 30; devices keep it as they like, it says nothing of the COB-ID.

/// Where a PDO of a node differs from its settings.
struct Comparison {
  std::optional<BootFailure> failure;  ///< It could not be read.
  bool communication_absent = false;
  bool mapping_absent = false;
  Raw cob_id = 0;  ///< Sub 1 as read.
  bool cob_id_differs = false;
  std::vector<SetupItem> parameters;  ///< Type and times that differ.
  bool mapping_differs = false;
  bool timing_known = false;    ///< The node has all that decides when a TPDO comes.
  bool timing_differs = false;  ///< Part of that differs.
  bool must_not_write = false;  ///< Something with policy verify differs.
  std::string text;             ///< The first difference.

  [[nodiscard]] bool differs() const noexcept { return cob_id_differs || !parameters.empty() || mapping_differs; }
};

class PdoSetup {
 public:
  PdoSetup(SetupSession& session, PdoRole role, const PdoSettings& pdo)
      : session_(session),
        pdo_(pdo),
        name_((role == PdoRole::transmit ? "TPDO" : "RPDO") + std::to_string(pdo.number)),
        communication_(static_cast<std::uint16_t>(
            (role == PdoRole::transmit ? kTpdoCommunication : kRpdoCommunication) + pdo.number - 1)),
        mapping_(static_cast<std::uint16_t>(communication_ + kMappingOffset)) {}

  boost::asio::awaitable<Comparison> compare();
  /// Writes what differs. `found` must not be a failure.
  boost::asio::awaitable<std::optional<BootFailure>> apply(const Comparison& found);
  /// Reads back what apply() wrote, and what a node may have changed by itself meanwhile.
  boost::asio::awaitable<std::optional<BootFailure>> confirm(const Comparison& written);

 private:
  boost::asio::awaitable<void> compare_parameters(Comparison& found);
  boost::asio::awaitable<void> compare_mapping(Comparison& found);
  boost::asio::awaitable<std::optional<BootFailure>> write(SetupItem item);
  boost::asio::awaitable<std::optional<BootFailure>> write_mapping();
  boost::asio::awaitable<std::optional<BootFailure>> confirm_item(SetupItem item, Raw ignored = 0);
  [[nodiscard]] Raw enabled_cob_id(const Comparison& found) const;

  [[nodiscard]] std::vector<SetupItem> wanted_parameters() const;
  [[nodiscard]] SetupItem cob_id_item(Raw wanted) const;
  [[nodiscard]] SetupItem count_item(std::size_t count) const;
  [[nodiscard]] SetupItem entry_item(std::size_t position) const;
  void note(Comparison& found, SetupPolicy policy, const SetupItem& item, Raw value) const;

  SetupSession& session_;
  const PdoSettings& pdo_;
  std::string name_;
  std::uint16_t communication_;
  std::uint16_t mapping_;
};

boost::asio::awaitable<Comparison> PdoSetup::compare() {
  Comparison found;
  const Result<Raw> cob_id = co_await session_.read({communication_, kCobId}, DataType::u32);
  if (cob_id.has_error()) {
    found.communication_absent = is_absent(cob_id.error());
    if (!found.communication_absent) {
      found.failure = session_.failure(cob_id.error(), name_ + " COB-ID");
    }
    co_return found;
  }
  found.cob_id = cob_id.value();
  if (pdo_.communication != SetupPolicy::assume) {
    found.cob_id_differs = (found.cob_id & ~kRtrForbidden) != pdo_.cob_id;
    if (found.cob_id_differs) {
      note(found, pdo_.communication, cob_id_item(pdo_.cob_id), found.cob_id);
    }
    co_await compare_parameters(found);
  } else if (pdo_.mapping_policy == SetupPolicy::write && (found.cob_id & kInvalid) != 0) {
    // An earlier set-up of the mapping that was interrupted leaves it like that; no TPDO would ever come. Another
    // COB-ID was never meant to be used.
    found.cob_id_differs = true;
    note(found, pdo_.mapping_policy, cob_id_item(found.cob_id & ~kInvalid), found.cob_id);
    if ((found.cob_id & kIdentifier) != pdo_.cob_id) {
      found.failure = session_.difference(name_ + " is switched off and has another COB-ID than assumed");
    }
  }
  if (!found.failure && pdo_.mapping_policy != SetupPolicy::assume) {
    co_await compare_mapping(found);
  }
  co_return found;
}

boost::asio::awaitable<void> PdoSetup::compare_parameters(Comparison& found) {
  found.timing_known = pdo_.transmission_type.has_value();
  for (const SetupItem& item : wanted_parameters()) {
    const Result<Raw> value = co_await session_.read(item.object, item.type);
    const bool timing = item.object.sub != kInhibitTime;
    if (value.has_error()) {
      if (!is_absent(value.error())) {
        found.failure = session_.failure(value.error(), item.name);
        co_return;
      }
      found.timing_known = found.timing_known && !timing;
    } else if (value.value() != item.wanted) {
      note(found, pdo_.communication, item, value.value());
      found.parameters.push_back(item);
      found.timing_differs = found.timing_differs || timing;
    }
  }
}

boost::asio::awaitable<void> PdoSetup::compare_mapping(Comparison& found) {
  const SetupItem count = count_item(pdo_.mapping.size());
  const Result<Raw> mapped = co_await session_.read(count.object, count.type);
  if (mapped.has_error()) {
    found.mapping_absent = is_absent(mapped.error());
    if (!found.mapping_absent) {
      found.failure = session_.failure(mapped.error(), count.name);
    }
    co_return;
  }
  if (mapped.value() != count.wanted) {
    found.mapping_differs = true;
    note(found, pdo_.mapping_policy, count, mapped.value());
    co_return;
  }
  for (std::size_t position = 0; position < pdo_.mapping.size(); ++position) {
    const SetupItem entry = entry_item(position);
    const Result<Raw> value = co_await session_.read(entry.object, entry.type);
    if (value.has_error()) {
      found.failure = session_.failure(value.error(), entry.name);
      co_return;
    }
    if (value.value() != entry.wanted) {
      found.mapping_differs = true;
      note(found, pdo_.mapping_policy, entry, value.value());
      co_return;
    }
  }
}

// The order of CiA 301 §7.5.2.36: many devices refuse any change while the PDO is valid, some change the mapping's sub
// 0 to 0 by themselves meanwhile, and COB-IDs may be changed only while it is invalid.
boost::asio::awaitable<std::optional<BootFailure>> PdoSetup::apply(const Comparison& found) {
  std::optional<BootFailure> failure;
  if ((found.cob_id & kInvalid) == 0) {
    failure = co_await write(cob_id_item(found.cob_id | kInvalid));
  }
  if (!failure && found.mapping_differs) {
    failure = co_await write_mapping();
  }
  for (std::size_t i = 0; !failure && i < found.parameters.size(); ++i) {
    failure = co_await write(found.parameters[i]);
  }
  if (!failure) {
    failure = co_await write(cob_id_item(enabled_cob_id(found)));
  }
  co_return failure;
}

boost::asio::awaitable<std::optional<BootFailure>> PdoSetup::confirm(const Comparison& written) {
  std::vector<SetupItem> items = written.parameters;
  if (pdo_.mapping_policy != SetupPolicy::assume && !written.mapping_absent) {
    items.push_back(count_item(pdo_.mapping.size()));  // Some clear it when the PDO is switched off.
  }
  for (std::size_t position = 0; written.mapping_differs && position < pdo_.mapping.size(); ++position) {
    items.push_back(entry_item(position));
  }
  std::optional<BootFailure> failure = co_await confirm_item(cob_id_item(enabled_cob_id(written)), kRtrForbidden);
  for (std::size_t i = 0; !failure && i < items.size(); ++i) {
    failure = co_await confirm_item(items[i]);
  }
  co_return failure;
}

boost::asio::awaitable<std::optional<BootFailure>> PdoSetup::confirm_item(SetupItem item, Raw ignored) {
  std::optional<BootFailure> failure;
  const Result<Raw> value = co_await session_.read(item.object, item.type);
  if (value.has_error()) {
    failure = session_.failure(value.error(), item.name);
  } else if ((value.value() & ~ignored) != (item.wanted & ~ignored)) {
    failure = session_.difference(difference_text(item, value.value()) + " after it was written");
  }
  co_return failure;
}

Raw PdoSetup::enabled_cob_id(const Comparison& found) const {
  return pdo_.communication == SetupPolicy::assume ? found.cob_id & ~kInvalid
                                                   : (found.cob_id & kRtrForbidden) | pdo_.cob_id;
}

boost::asio::awaitable<std::optional<BootFailure>> PdoSetup::write_mapping() {
  std::optional<BootFailure> failure = co_await write(count_item(0));
  for (std::size_t position = 0; !failure && position < pdo_.mapping.size(); ++position) {
    failure = co_await write(entry_item(position));
  }
  if (!failure) {
    failure = co_await write(count_item(pdo_.mapping.size()));
  }
  co_return failure;
}

boost::asio::awaitable<std::optional<BootFailure>> PdoSetup::write(SetupItem item) {
  std::optional<BootFailure> failure;
  const Result<void> written = co_await session_.write(item.object, item.type, item.wanted);
  if (written.has_error()) {
    failure = session_.failure(written.error(), "writing " + item.name + " = 0x" + hex(item.wanted, 1));
  }
  co_return failure;
}

std::vector<SetupItem> PdoSetup::wanted_parameters() const {
  std::vector<SetupItem> items;
  if (pdo_.transmission_type) {
    items.push_back({{communication_, kTransmissionType},
                     DataType::u8,
                     *pdo_.transmission_type,
                     name_ + " transmission type",
                     pdo_.communication});
  }
  if (pdo_.inhibit_time) {
    items.push_back({{communication_, kInhibitTime},
                     DataType::u16,
                     *pdo_.inhibit_time,
                     name_ + " inhibit time",
                     pdo_.communication});
  }
  if (pdo_.event_timer) {
    items.push_back(
        {{communication_, kEventTimer}, DataType::u16, *pdo_.event_timer, name_ + " event timer", pdo_.communication});
  }
  return items;
}

SetupItem PdoSetup::cob_id_item(Raw wanted) const {
  return {{communication_, kCobId}, DataType::u32, wanted, name_ + " COB-ID", pdo_.communication};
}

SetupItem PdoSetup::count_item(std::size_t count) const {
  return {{mapping_, 0}, DataType::u8, count, name_ + " number of mapped objects", pdo_.mapping_policy};
}

SetupItem PdoSetup::entry_item(std::size_t position) const {
  const MappedObject& mapped = pdo_.mapping[position];
  const Raw entry = (Raw{mapped.object.index} << 16U) | (Raw{mapped.object.sub} << 8U) | mapped.bits;
  const auto sub = static_cast<std::uint8_t>(position + 1);
  return {{mapping_, sub}, DataType::u32, entry, name_ + " mapping", pdo_.mapping_policy};
}

void PdoSetup::note(Comparison& found, SetupPolicy policy, const SetupItem& item, Raw value) const {
  found.must_not_write = found.must_not_write || policy == SetupPolicy::verify;
  if (found.text.empty()) {
    found.text = difference_text(item, value);
  }
}

}  // namespace

boost::asio::awaitable<PdoSetupOutcome> set_up_pdo(SetupSession& session, PdoRole role, const PdoSettings& pdo) {
  PdoSetupOutcome outcome;
  if (pdo.communication == SetupPolicy::assume && pdo.mapping_policy == SetupPolicy::assume) {
    co_return outcome;
  }
  PdoSetup setup(session, role, pdo);
  const Comparison found = co_await setup.compare();
  outcome.failure = found.failure;
  outcome.timing_confirmed = found.timing_known && !found.timing_differs;
  outcome.absent = found.communication_absent || found.mapping_absent;
  if (outcome.failure || !found.differs()) {
    co_return outcome;
  }
  if (session.inspecting() || found.must_not_write) {
    outcome.failure = session.difference(found.text);
    co_return outcome;
  }
  outcome.failure = co_await setup.apply(found);
  if (!outcome.failure) {
    outcome.failure = co_await setup.confirm(found);
  }
  outcome.timing_confirmed = found.timing_known && !outcome.failure;
  co_return outcome;
}

}  // namespace canopen
