#include "simulator/pdo_objects.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace simulator {
namespace {

constexpr std::uint32_t kExtended = 0x20000000U;  ///< bit 29: 29-bit identifier

/// CAN-IDs no PDO may use (CiA 301 §7.3.5, restricted CAN-IDs).
bool restricted(std::uint32_t id) {
  return id <= 0x7F || (id >= 0x101 && id <= 0x180) || (id >= 0x581 && id <= 0x5FF) || (id >= 0x601 && id <= 0x67F) ||
         id >= 0x6E0;
}

/// The rules of writing one PDO's objects.
class PdoWriter {
 public:
  PdoWriter(const PdoContext& context, std::uint8_t number, bool transmit, PdoSettings& settings,
            std::function<void()> changed)
      : context_(context), number_(number), transmit_(transmit), settings_(settings), changed_(std::move(changed)) {}

  Abort set_cob_id(std::uint32_t value) {
    if (locked()) {
      return Abort::device_state;
    }
    const bool enabling = (value & kPdoDisabled) == 0;
    if ((value & kExtended) != 0 || (enabling && restricted(value & 0x7FFU))) {
      return Abort::invalid_value;
    }
    if (context_.rules.strict_procedure && settings_.enabled() && enabling && (value & 0x7FFU) != settings_.id()) {
      return Abort::invalid_value;
    }
    settings_.cob_id = value;
    return done();
  }

  Abort set_type(std::uint32_t value) {
    const auto type = static_cast<std::uint8_t>(value);
    if (locked()) {
      return Abort::device_state;
    }
    const bool known =
        transmit_ ? context_.rules.triggers(number_, type, settings_.event).has_value() : type <= 240 || type >= 254;
    if (!known) {
      return Abort::invalid_value;
    }
    settings_.type = type;
    return done();
  }

  Abort set_inhibit(std::uint32_t value) {
    // CiA 301 §7.5.2.37: not while the PDO exists.
    if (locked() || (context_.rules.strict_procedure && settings_.enabled())) {
      return Abort::device_state;
    }
    settings_.inhibit = static_cast<std::uint16_t>(value);
    return done();
  }

  Abort set_event(std::uint32_t value) {
    const auto event = static_cast<std::uint16_t>(value);
    if (locked()) {
      return Abort::device_state;
    }
    if (transmit_ && !context_.rules.triggers(number_, settings_.type, event)) {
      return Abort::invalid_value;
    }
    settings_.event = event;
    return done();
  }

  Abort set_sync_start(std::uint32_t value) {
    if (locked() || (context_.rules.strict_procedure && settings_.enabled())) {
      return Abort::device_state;
    }
    if (value > 240) {
      return Abort::invalid_value;
    }
    settings_.sync_start = static_cast<std::uint8_t>(value);
    return done();
  }

  Abort set_count(std::uint32_t value) {
    const Abort refused = mapping_locked();
    if (refused != Abort::none) {
      return refused;
    }
    const auto count = static_cast<std::uint8_t>(value);
    const Abort abort = check_map(context_.dictionary, settings_, count, transmit_);
    if (abort != Abort::none) {
      return abort;
    }
    const std::uint32_t mandatory = transmit_ ? context_.rules.mandatory_transmit : context_.rules.mandatory_receive;
    if (number_ == 1 && mandatory != 0 && count != 0 &&
        std::find(settings_.map.begin(), settings_.map.begin() + count, mandatory) == settings_.map.begin() + count) {
      return Abort::general;
    }
    settings_.count = count;
    return done();
  }

  Abort set_entry(std::size_t position, std::uint32_t value) {
    const Abort refused = mapping_locked();
    if (refused != Abort::none) {
      return refused;
    }
    if (context_.rules.strict_procedure && settings_.count != 0) {
      return Abort::unsupported_access;
    }
    const Abort abort = check_entry(context_.dictionary, value, transmit_);
    if (abort != Abort::none) {
      return abort;
    }
    settings_.map[position] = value;
    return done();
  }

 private:
  [[nodiscard]] bool locked() const {
    return context_.rules.pre_operational_only && context_.state() != NmtState::pre_operational;
  }
  [[nodiscard]] Abort mapping_locked() const {
    if (locked()) {
      return Abort::device_state;
    }
    // CiA 301 §7.5.2.38: the PDO is disabled first.
    return context_.rules.strict_procedure && settings_.enabled() ? Abort::unsupported_access : Abort::none;
  }
  Abort done() {
    changed_();
    return Abort::none;
  }

  const PdoContext& context_;
  std::uint8_t number_;
  bool transmit_;
  PdoSettings& settings_;
  std::function<void()> changed_;
};

Object number_object(std::uint8_t size, std::function<std::uint32_t()> read,
                     std::function<Abort(std::uint32_t)> write) {
  Object object;
  object.size = size;
  object.read = std::move(read);
  object.write = std::move(write);
  return object;
}

void define_mapping(ObjectDictionary& dictionary, std::uint16_t index, bool writable, PdoSettings& settings,
                    const std::shared_ptr<PdoWriter>& writer) {
  const Access access = writable ? Access::read_write : Access::read_only;
  Object& count = dictionary.add({index, 0}, number_object(
                                                 1, [&settings] { return settings.count; },
                                                 [writer](std::uint32_t value) { return writer->set_count(value); }));
  count.access = access;
  for (std::size_t i = 0; i < kMapEntries; ++i) {
    Object& entry = dictionary.add({index, static_cast<std::uint8_t>(i + 1)},
                                   number_object(
                                       4, [&settings, i] { return settings.map[i]; },
                                       [writer, i](std::uint32_t value) { return writer->set_entry(i, value); }));
    entry.access = access;
  }
}

}  // namespace

void define_pdo_objects(ObjectDictionary& dictionary, const PdoContext& context, std::uint8_t number, bool transmit,
                        PdoSettings& settings, std::function<void()> changed) {
  // The objects' actions share the writer: none of them owns the others.
  const auto writer = std::make_shared<PdoWriter>(context, number, transmit, settings, std::move(changed));
  const auto index = static_cast<std::uint16_t>((transmit ? 0x1800 : 0x1400) + number - 1);
  const PdoRules& rules = context.rules;
  std::uint8_t highest = 2;
  dictionary.add({index, 1}, number_object(
                                 4, [&settings] { return settings.cob_id; },
                                 [writer](std::uint32_t value) { return writer->set_cob_id(value); }));
  dictionary.add({index, 2}, number_object(
                                 1, [&settings] { return settings.type; },
                                 [writer](std::uint32_t value) { return writer->set_type(value); }));
  if (transmit) {
    dictionary.add({index, 3}, number_object(
                                   2, [&settings] { return settings.inhibit; },
                                   [writer](std::uint32_t value) { return writer->set_inhibit(value); }));
  }
  if (transmit || rules.rpdo_deadline) {
    highest = 5;
    dictionary.add({index, 5}, number_object(
                                   2, [&settings] { return settings.event; },
                                   [writer](std::uint32_t value) { return writer->set_event(value); }));
  }
  if (transmit && rules.sync_start_value) {
    highest = 6;
    dictionary.add({index, 6}, number_object(
                                   1, [&settings] { return settings.sync_start; },
                                   [writer](std::uint32_t value) { return writer->set_sync_start(value); }));
  }
  dictionary.add_constant({index, 0}, 1, highest);
  define_mapping(dictionary, static_cast<std::uint16_t>(index + 0x200), rules.mapping_writable, settings, writer);
}

}  // namespace simulator
