#pragma once

#include <cstddef>
#include <string_view>

#include "bridges/process/image.h"
#include "config/model.h"

namespace process {

// A drive with one of everything, laid out as the Veichi card does it: TPDO1 with the status word, TPDO2 with the fault
// code, two polled objects, RPDO1 with three set-points.
namespace test {

inline constexpr canopen::ObjectAddress kStatusWord{0x2030, 3};
inline constexpr canopen::ObjectAddress kFaultCode{0x2030, 4};
inline constexpr canopen::ObjectAddress kControl{0x2030, 2};
inline constexpr canopen::ObjectAddress kFrequency{0x2030, 1};
inline constexpr canopen::ObjectAddress kTorque{0x2030, 6};
inline constexpr canopen::ObjectAddress kLimit{0x2030, 5};
inline constexpr canopen::ObjectAddress kOutput{0x2021, 2};
inline constexpr canopen::ObjectAddress kTemperature{0x2021, 0x0D};

inline constexpr canopen::Raw kRunningBit = 0x01;
inline constexpr canopen::Raw kReverseBit = 0x08;
inline constexpr canopen::Raw kFaultBit = 0x10;
inline constexpr canopen::Raw kWarningBit = 0x40;

inline constexpr canopen::Duration kPeriod = std::chrono::milliseconds(100);

config::Signal word(std::string_view name, canopen::ObjectAddress object, canopen::DataType type, config::Source source,
                    config::Access access = config::Access::read);
config::Signal bit(std::string_view name, std::size_t from, std::uint64_t mask);
SignalId id(const config::Drive& model, std::string_view name);
/// Node 5, every writer allowed.
config::Drive drive();

}  // namespace test
}  // namespace process
