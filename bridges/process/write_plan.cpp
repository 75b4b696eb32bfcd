#include "bridges/process/write_plan.h"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "bridges/process/command_checks.h"
#include "bridges/process/commanded.h"

namespace process {
namespace {

// The RPDO of the first of these fields with all others of it, or nothing where they do not complete it.
WriteStep rpdo_step(const Commanded& commanded, const Field& first, std::span<const Field> remaining) {
  const std::uint16_t rpdo = commanded.rpdo_of(first.signal);
  if (rpdo == 0) {
    return {};
  }
  WriteStep step{rpdo, fields_of(commanded, rpdo, remaining)};
  return commanded.values(rpdo, step.fields) ? step : WriteStep{};
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

std::vector<Field> in_writing_order(const Commanded& commanded, std::vector<Field> fields) {
  std::vector<Field> ordered;
  for (auto field = fields.rbegin(); field != fields.rend(); ++field) {
    const bool given_later =
        std::any_of(ordered.begin(), ordered.end(), [&](const Field& later) { return later.signal == field->signal; });
    if (!given_later) {
      ordered.push_back(*field);
    }
  }
  std::reverse(ordered.begin(), ordered.end());
  const auto control = std::find_if(ordered.begin(), ordered.end(),
                                    [&](const Field& field) { return commanded.is_control(field.signal); });
  if (control != ordered.end()) {
    std::rotate(control, control + 1, ordered.end());
  }
  return ordered;
}

WriteStep next_step(const Commanded& commanded, std::span<const Field> remaining) {
  WriteStep last;
  for (const Field& field : remaining) {
    WriteStep step = rpdo_step(commanded, field, remaining);
    if (step.fields.empty()) {
      step = {0, {field}};
    }
    const bool writes_control = std::any_of(step.fields.begin(), step.fields.end(),
                                            [&](const Field& each) { return commanded.is_control(each.signal); });
    if (!writes_control) {
      return step;
    }
    last = std::move(step);
  }
  return last;
}

std::optional<SignalId> first_unsendable(const config::Drive& model, const Commanded& commanded,
                                         std::span<const Field> remaining) {
  const auto found = std::find_if(remaining.begin(), remaining.end(), [&](const Field& field) {
    return model.signals[field.signal].pdo_only && rpdo_step(commanded, field, remaining).fields.empty();
  });
  return found == remaining.end() ? std::nullopt : std::optional(found->signal);
}

std::vector<Field> fields_of(const Commanded& commanded, std::uint16_t rpdo, std::span<const Field> fields) {
  std::vector<Field> found;
  std::copy_if(fields.begin(), fields.end(), std::back_inserter(found),
               [&](const Field& field) { return commanded.rpdo_of(field.signal) == rpdo; });
  return found;
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
    const std::optional<SignalId> signal = writable_signal(model, mapped.object);
    if (mapped.use == canopen::FieldUse::commanded && signal) {
      names.push_back(model.signals[*signal].name);
    }
  }
  return "write " + listed(names) + " together";
}

}  // namespace process
