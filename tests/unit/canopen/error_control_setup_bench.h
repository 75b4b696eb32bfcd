#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {

/// What a boot writes of error control, and in which width.
class ErrorControlSetupBench : public NodeLifeBench {
 protected:
  [[nodiscard]] bool remarked(const std::string& part) const {
    return std::any_of(events_.remarks.begin(), events_.remarks.end(),
                       [&](const std::string& remark) { return remark.find(part) != std::string::npos; });
  }
  /// The length in bytes of each download of the object, in order.
  [[nodiscard]] std::vector<unsigned> written_widths(ObjectAddress object) const {
    std::vector<unsigned> widths;
    for (const Frame& frame : slave_.heard_on(0x605)) {
      const bool of_it =
          frame.data[1] == (object.index & 0xFFU) && frame.data[2] == object.index >> 8U && frame.data[3] == object.sub;
      if (of_it && (frame.data[0] & 0xE0U) == 0x20) {
        widths.push_back(4U - ((frame.data[0] >> 2U) & 3U));
      }
    }
    return widths;
  }
  /// It takes what is written, and shows another value.
  void round_to(ObjectAddress object, DataType type, Raw value) {
    slave_.on_write([this, object, type, value](ObjectAddress written) {
      if (written == object) {
        slave_.set(object, type, value);
      }
    });
  }
};

}  // namespace canopen
