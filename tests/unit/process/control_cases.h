#pragma once

#include <gtest/gtest.h>

#include <string>

#include "bridges/process/writer.h"

// Who commands in the tables of lease and timeout, and how their rows are named.

namespace process::test {

inline const Writer kPlc{.way = Writer::Way::modbus, .address = "192.0.2.7"};
inline const Writer kPanel{.way = Writer::Way::modbus, .address = "192.0.2.8"};
inline const Writer kMqtt{.way = Writer::Way::mqtt, .address = {}};
inline const Writer kLocal{.way = Writer::Way::local, .address = {}};

template <class Case>
std::string row_name(const testing::TestParamInfo<Case>& info) {
  return info.param.name;
}

}  // namespace process::test
