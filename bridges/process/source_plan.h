#pragma once

#include <cstddef>
#include <vector>

#include "bridges/process/image.h"
#include "canopen/clock.h"
#include "canopen/object.h"
#include "config/model.h"

namespace process {

/// What one source of values consists of, worked out once from the model.
struct SourcePlan {
  /// A signal that is a whole object. `position` is that of its value in the TPDO's mapping; 0 for a polled object.
  struct Word {
    SignalId signal = 0;
    std::size_t position = 0;
  };
  /// An object of the source as SDO reads it.
  struct Object {
    canopen::ObjectAddress address;
    canopen::DataType type = canopen::DataType::u16;
    std::size_t position = 0;
  };

  config::Source source;
  canopen::Duration period{};     ///< Of a TPDO; zero: on change.
  canopen::Duration poll{};       ///< Between two SDO reads, where SDO reads it.
  std::size_t values = 1;         ///< In the mapping of a TPDO, else 1.
  std::vector<Word> words;        ///< In order of signals.
  std::vector<Object> objects;    ///< Each once.
  std::vector<SignalId> derived;  ///< Booleans out of these words, words first.
  std::vector<SignalId> signals;  ///< All of them, in order.
};

/// The sources of all readable signals: the TPDOs that carry any, then the polled objects, each once.
[[nodiscard]] std::vector<SourcePlan> plan_sources(const config::Drive& model);

}  // namespace process
