#include "bridges/process/write_plan.h"

#include <algorithm>
#include <string_view>

#include "canopen/node/remote_node.h"

namespace process {
namespace {

constexpr std::string_view kControlCommand = "control_command";

bool is_control(const config::Drive& model, const Field& field) {
  return model.signals[field.signal].name == kControlCommand;
}

bool has_control(const config::Drive& model, const WriteStep& step) {
  return std::any_of(step.fields.begin(), step.fields.end(),
                     [&](const Field& field) { return is_control(model, field); });
}

// The RPDO of the first of these fields with all others of it, or nothing where they do not complete it.
WriteStep rpdo_step(const config::Drive& model, const canopen::RemoteNode& node, const Field& first,
                    std::span<const Field> remaining) {
  WriteStep step;
  step.rpdo = node.rpdo_of(model.signals[first.signal].object);
  if (step.rpdo == 0) {
    return {};
  }
  std::vector<canopen::ObjectValue> values;
  for (const Field& field : remaining) {
    if (node.rpdo_of(model.signals[field.signal].object) == step.rpdo) {
      step.fields.push_back(field);
      values.push_back(object_value(model, field));
    }
  }
  return node.rpdo_complete(step.rpdo, values) ? step : WriteStep{};
}

const config::Signal* signal_of(const config::Drive& model, canopen::ObjectAddress object) {
  const auto found = std::find_if(model.signals.begin(), model.signals.end(), [&](const config::Signal& signal) {
    return signal.object == object && config::writable(signal.access) && !signal.derived;
  });
  return found == model.signals.end() ? nullptr : &*found;
}

std::string listed(const std::vector<std::string_view>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) {
      text += i + 1 == names.size() ? " and " : ", ";
    }
    text += names[i];
  }
  return text;
}

}  // namespace

std::vector<Field> in_writing_order(const config::Drive& model, std::vector<Field> fields) {
  std::vector<Field> ordered;
  for (auto field = fields.rbegin(); field != fields.rend(); ++field) {
    const bool given_later =
        std::any_of(ordered.begin(), ordered.end(), [&](const Field& later) { return later.signal == field->signal; });
    if (!given_later) {
      ordered.push_back(*field);
    }
  }
  std::reverse(ordered.begin(), ordered.end());
  const auto control =
      std::find_if(ordered.begin(), ordered.end(), [&](const Field& field) { return is_control(model, field); });
  if (control != ordered.end()) {
    std::rotate(control, control + 1, ordered.end());
  }
  return ordered;
}

WriteStep next_step(const config::Drive& model, const canopen::RemoteNode& node, std::span<const Field> remaining,
                    bool allow_rpdo) {
  WriteStep last;
  for (const Field& field : remaining) {
    WriteStep step = allow_rpdo ? rpdo_step(model, node, field, remaining) : WriteStep{};
    if (step.fields.empty()) {
      step = {0, {field}};
    }
    if (!has_control(model, step)) {
      return step;
    }
    last = std::move(step);
  }
  return last;
}

canopen::ObjectValue object_value(const config::Drive& model, const Field& field) {
  const config::Signal& signal = model.signals[field.signal];
  return {signal.object, signal.type, field.raw};
}

std::string completion_text(const config::Drive& model, std::uint16_t rpdo) {
  const auto& rpdos = model.node.rpdos;
  const auto found = std::find_if(rpdos.begin(), rpdos.end(), [&](const auto& pdo) { return pdo.number == rpdo; });
  if (found == rpdos.end()) {
    return {};
  }
  std::vector<std::string_view> names;
  for (const canopen::MappedObject& mapped : found->mapping) {
    if (mapped.use == canopen::FieldUse::unnamed) {
      return "RPDO" + std::to_string(rpdo) + " also carries " + canopen::to_string(mapped.object) +
             ", which is neither a signal nor declared unused";
    }
    const config::Signal* signal = signal_of(model, mapped.object);
    if (mapped.use == canopen::FieldUse::commanded && signal != nullptr) {
      names.push_back(signal->name);
    }
  }
  return "write " + listed(names) + " together";
}

}  // namespace process
