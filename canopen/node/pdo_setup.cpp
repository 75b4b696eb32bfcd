#include "canopen/node/pdo_setup.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "canopen/hex.h"
#include "canopen/node/pdo_times.h"
#include "canopen/node/wanted_objects.h"

namespace canopen {
namespace {

using Failure = std::optional<BootFailure>;
using Items = std::vector<SetupItem>;

/// One PDO of one node: where it differs from its settings, and the way to make it so.
class PdoSetup {
 public:
  PdoSetup(SetupSession& session, PdoRole role, const PdoSettings& pdo)
      : session_(session), pdo_(pdo), role_(role), name_(pdo_name(role, pdo)) {}

  boost::asio::awaitable<PdoSetupOutcome> run() {
    PdoSetupOutcome outcome;
    outcome.failure = co_await compare();
    if (!outcome.failure && !difference_.empty()) {
      if (may_write()) {
        outcome.failure = co_await apply();
      } else {
        outcome.failure = session_.difference(difference_);
      }
    }
    if (outcome.failure && !outcome.failure->interrupted && switched_off_) {
      co_await mend(*outcome.failure);
    }
    outcome.absent = absent_;
    outcome.timing_confirmed = timing_known_ && !outcome.failure;
    outcome.remarks = std::move(remarks_);
    co_return outcome;
  }

 private:
  boost::asio::awaitable<Failure> compare() {
    const SetupItem item = cob_id_item(pdo_.cob_id);
    const Result<Raw> found = co_await session_.read(item.object, item.type);
    if (found.has_error()) {
      absent_ = is_absent(found.error());
      co_return absent_ ? lacking(why_not_without_object(role_, pdo_))
                        : Failure(session_.failure(found.error(), item.name));
    }
    cob_id_ = found.value();
    Failure failure = compare_cob_id();
    if (!failure && (pdo_.communication != SetupPolicy::assume || relies_on_timer(pdo_))) {
      failure = co_await compare_parameters();
    }
    if (!failure && pdo_.mapping_policy == SetupPolicy::write && !difference_.empty() && may_write()) {
      failure = co_await switch_off();  // Some clear the mapping then, so it is looked at after that.
    }
    if (!failure && pdo_.mapping_policy != SetupPolicy::assume) {
      failure = co_await compare_mapping();
    }
    co_return failure;
  }

  Failure compare_cob_id() {
    const Raw shown = cob_id_ & ~kPdoRtrForbidden;
    const bool assumed = pdo_.communication == SetupPolicy::assume;
    // A set-up of the mapping that was interrupted leaves it like that, and no PDO would ever pass.
    const bool left_off = pdo_.mapping_policy == SetupPolicy::write && shown == (pdo_.cob_id | kPdoInvalid);
    if (left_off || (!assumed && shown != pdo_.cob_id)) {
      note(left_off ? SetupPolicy::write : pdo_.communication, cob_id_item(pdo_.cob_id), cob_id_);
    } else if (assumed && pdo_.mapping_policy == SetupPolicy::write && (cob_id_ & kPdoInvalid) != 0) {
      // Another COB-ID was never meant to be used.
      return session_.difference(name_ + " is switched off and has another COB-ID than assumed");
    }
    return std::nullopt;
  }

  boost::asio::awaitable<Failure> compare_parameters() {
    timing_known_ = pdo_.transmission_type.has_value();
    for (const SetupItem& item : wanted_parameters(role_, pdo_)) {
      const Result<Raw> found = co_await session_.read(item.object, item.type);
      if (found.has_value() && session_.inspecting() && found.value() != item.wanted && will_do(item, found.value())) {
        remarks_.push_back(difference_text(item, found.value()) + ", which will do");
      } else if (found.has_value() && found.value() != item.wanted) {
        note(item.policy, item, found.value());
        parameters_.push_back(item);
      } else if (found.has_error() && is_absent(found.error())) {
        Failure failure =
            item.object.sub == kPdoEventTimer ? lacking(why_not_without_timer(role_, pdo_)) : std::nullopt;
        if (failure) {
          co_return failure;
        }
        timing_known_ = timing_known_ && item.object.sub == kPdoInhibitTime;
      } else if (found.has_error()) {
        co_return session_.failure(found.error(), item.name);
      }
    }
    co_return std::nullopt;
  }

  [[nodiscard]] static Failure lacking(std::string why) {
    return why.empty() ? std::nullopt : Failure(BootFailure{BootResult::not_configured, std::move(why), false});
  }

  boost::asio::awaitable<Failure> compare_mapping() {
    for (const SetupItem& item : wanted_mapping(role_, pdo_)) {
      const Result<Raw> found = co_await session_.read(item.object, item.type);
      if (found.has_error()) {
        absent_ = item.object.sub == 0 && is_absent(found.error());
        co_return absent_ ? lacking(why_not_without_mapping(role_, pdo_))
                          : Failure(session_.failure(found.error(), item.name));
      }
      if (found.value() != item.wanted) {
        note(pdo_.mapping_policy, item, found.value());
        mapping_differs_ = true;
        break;
      }
    }
    co_return std::nullopt;
  }

  void note(SetupPolicy policy, const SetupItem& item, Raw found) {
    must_not_write_ = must_not_write_ || policy == SetupPolicy::verify;
    if (difference_.empty()) {
      difference_ = difference_text(item, found);
    }
  }

  [[nodiscard]] bool may_write() const { return !session_.inspecting() && !must_not_write_; }

  boost::asio::awaitable<Failure> write(const SetupItem& item) {
    const Result<void> written = co_await session_.write(item);
    if (written.has_error()) {
      co_return session_.failure(written.error(), "writing " + item.name + " = 0x" + hex(item.wanted, 1));
    }
    co_return std::nullopt;
  }

  boost::asio::awaitable<Failure> switch_off() {
    Failure failure;
    if (!switched_off_ && found_valid()) {
      failure = co_await write(cob_id_item(cob_id_ | kPdoInvalid));
    }
    switched_off_ = !failure;
    co_return failure;
  }

  // The order of CiA 301 §7.5.2.36: many devices refuse any change while the PDO is valid, some change the mapping's
  // sub 0 to 0 by themselves meanwhile, and COB-IDs may be changed only while it is invalid.
  boost::asio::awaitable<Failure> apply() {
    Failure failure = co_await switch_off();
    Items items = parameters_;
    if (mapping_differs_) {
      const Items mapping = wanted_mapping(role_, pdo_);
      items.insert(items.begin(), mapping.begin(), mapping.end());
      items.front().wanted = 0;
      items.insert(items.begin() + static_cast<std::ptrdiff_t>(mapping.size()), mapping.front());
    }
    items.push_back(cob_id_item(enabled()));
    for (std::size_t i = 0; !failure && i < items.size(); ++i) {
      failure = co_await write(items[i]);
    }
    if (!failure) {
      switched_off_ = false;
      failure = co_await confirm();
    }
    co_return failure;
  }

  /// It failed half-way: switches a PDO on again whose mapping is as it was. Of others people must know, for where its
  /// settings are only verified or assumed later nothing else would do it.
  boost::asio::awaitable<void> mend(BootFailure& failure) {
    bool left_off = true;
    if (!mapping_differs_ && found_valid()) {
      const Failure refused = co_await write(cob_id_item(cob_id_));
      left_off = refused.has_value();
    }
    if (left_off) {
      failure.text += "; " + name_ + " is left switched off";
    }
  }

  /// Reads back what was written.
  boost::asio::awaitable<Failure> confirm() {
    Items items = parameters_;
    items.insert(items.begin(), cob_id_item(enabled()));
    // One that is only verified was looked at before the PDO was switched off, and some clear the count then.
    if (mapping_differs_ || (pdo_.mapping_policy == SetupPolicy::verify && !absent_)) {
      const Items mapping = wanted_mapping(role_, pdo_);
      items.insert(items.end(), mapping.begin(), mapping_differs_ ? mapping.end() : mapping.begin() + 1);
    }
    for (const SetupItem& item : items) {
      const Result<Raw> found = co_await session_.read(item.object, item.type);
      if (found.has_error()) {
        co_return session_.failure(found.error(), item.name);
      }
      const Raw ignored = item.object == items.front().object ? kPdoRtrForbidden : 0;
      const bool differs = ((found.value() ^ item.wanted) & ~ignored) != 0;
      if (differs && will_do(item, found.value())) {
        remarks_.push_back(difference_text(item, found.value()) + " after it was written, which will do");
      } else if (differs) {
        co_return session_.difference(difference_text(item, found.value()) + " after it was written");
      }
    }
    co_return std::nullopt;
  }

  [[nodiscard]] bool found_valid() const { return (cob_id_ & kPdoInvalid) == 0; }
  [[nodiscard]] Raw enabled() const {
    return pdo_.communication == SetupPolicy::assume ? cob_id_ & ~kPdoInvalid
                                                     : (cob_id_ & kPdoRtrForbidden) | pdo_.cob_id;
  }
  [[nodiscard]] SetupItem cob_id_item(Raw wanted) const { return wanted_cob_id(role_, pdo_, wanted); }

  SetupSession& session_;
  const PdoSettings& pdo_;
  PdoRole role_;
  std::string name_;

  bool absent_ = false;
  Raw cob_id_ = 0;    ///< Sub 1 as found.
  Items parameters_;  ///< Type and times that differ.
  bool mapping_differs_ = false;
  bool switched_off_ = false;    ///< By us, or found so and begun with.
  bool timing_known_ = false;    ///< The node has all that decides when a TPDO comes.
  bool must_not_write_ = false;  ///< Something with policy verify differs.
  std::string difference_;       ///< The first one; empty: none.
  std::vector<std::string> remarks_;
};

}  // namespace

boost::asio::awaitable<PdoSetupOutcome> set_up_pdo(SetupSession& session, PdoRole role, const PdoSettings& pdo) {
  const bool assumed = pdo.communication == SetupPolicy::assume && pdo.mapping_policy == SetupPolicy::assume;
  if (assumed && !relies_on_timer(pdo)) {
    co_return PdoSetupOutcome{};
  }
  PdoSetup setup(session, role, pdo);
  co_return co_await setup.run();
}

}  // namespace canopen
