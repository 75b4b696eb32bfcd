#include "bridges/process/source_plan.h"

#include <algorithm>
#include <optional>

namespace process {
namespace {

// Keeps a poll of zero from reading without a pause.
constexpr canopen::Duration kShortestPoll = std::chrono::milliseconds(10);

const canopen::PdoSettings* find_tpdo(const config::Drive& model, std::uint16_t number) {
  const auto& tpdos = model.node.tpdos;
  const auto found = std::find_if(tpdos.begin(), tpdos.end(), [&](const auto& tpdo) { return tpdo.number == number; });
  return found == tpdos.end() ? nullptr : &*found;
}

std::optional<std::size_t> position_in(const canopen::PdoSettings& tpdo, canopen::ObjectAddress object) {
  const auto& mapping = tpdo.mapping;
  const auto found = std::find_if(mapping.begin(), mapping.end(), [&](const auto& m) { return m.object == object; });
  if (found == mapping.end()) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - mapping.begin());
}

class Planner {
 public:
  explicit Planner(const config::Drive& model) : model_(model) {}

  std::vector<SourcePlan> plan() {
    // TPDOs first: polled objects come behind them in the order of signals.
    for (const config::SourceKind kind : {config::SourceKind::tpdo, config::SourceKind::sdo}) {
      for (std::size_t i = 0; i < model_.signals.size(); ++i) {
        const config::Signal& signal = model_.signals[i];
        if (config::readable(signal.access) && !signal.derived && kind_of(signal) == kind) {
          add_word(static_cast<SignalId>(i), kind);
        }
      }
    }
    for (std::size_t i = 0; i < model_.signals.size(); ++i) {
      if (model_.signals[i].derived) {
        add_derived(static_cast<SignalId>(i), model_.signals[i].derived->from);
      }
    }
    for (SourcePlan& source : plan_) {
      std::sort(source.signals.begin(), source.signals.end());
    }
    return std::move(plan_);
  }

 private:
  // An RPDO cannot be read back, so a readable signal that goes out in one is polled.
  [[nodiscard]] config::SourceKind kind_of(const config::Signal& signal) const {
    const auto* tpdo =
        signal.source.kind == config::SourceKind::tpdo ? find_tpdo(model_, signal.source.number) : nullptr;
    const bool mapped = tpdo != nullptr && position_in(*tpdo, signal.object);
    return mapped ? config::SourceKind::tpdo : config::SourceKind::sdo;
  }

  void add_word(SignalId id, config::SourceKind kind) {
    const config::Signal& signal = model_.signals[id];
    SourcePlan& source = kind == config::SourceKind::tpdo ? tpdo_source(signal) : polled_source(signal);
    const std::size_t position =
        kind == config::SourceKind::tpdo ? *position_in(*find_tpdo(model_, signal.source.number), signal.object) : 0;
    source.poll = std::min(source.poll, std::max(signal.poll, kShortestPoll));
    source.words.push_back({id, position});
    source.signals.push_back(id);
    const bool known = std::any_of(source.objects.begin(), source.objects.end(),
                                   [&](const auto& object) { return object.position == position; });
    if (!known) {
      source.objects.push_back({signal.object, signal.type, position});
    }
  }

  void add_derived(SignalId id, std::size_t from) {
    for (SourcePlan& source : plan_) {
      const auto& ids = source.signals;
      if (std::find(ids.begin(), ids.end(), static_cast<SignalId>(from)) != ids.end()) {
        source.derived.push_back(id);
        source.signals.push_back(id);
        return;
      }
    }
  }

  SourcePlan& tpdo_source(const config::Signal& signal) {
    const auto found =
        std::find_if(plan_.begin(), plan_.end(), [&](const SourcePlan& s) { return s.source == signal.source; });
    if (found != plan_.end()) {
      return *found;
    }
    const canopen::PdoSettings& tpdo = *find_tpdo(model_, signal.source.number);
    SourcePlan& source = plan_.emplace_back();
    source.source = signal.source;
    source.period = tpdo.period;
    source.poll = canopen::Duration::max();
    source.values = tpdo.mapping.size();
    return source;
  }

  SourcePlan& polled_source(const config::Signal& signal) {
    const auto found = std::find_if(plan_.begin(), plan_.end(), [&](const SourcePlan& s) {
      return s.source.kind == config::SourceKind::sdo && s.objects.front().address == signal.object;
    });
    if (found != plan_.end()) {
      return *found;
    }
    SourcePlan& source = plan_.emplace_back();
    source.source = {config::SourceKind::sdo, 0};
    source.poll = canopen::Duration::max();
    return source;
  }

  const config::Drive& model_;
  std::vector<SourcePlan> plan_;
};

}  // namespace

std::vector<SourcePlan> plan_sources(const config::Drive& model) {
  return Planner(model).plan();
}

}  // namespace process
