#pragma once

#include "canopen/object.h"

// Objects of the communication profile (CiA 301 §7.5.2).

namespace canopen {

inline constexpr ObjectAddress kDeviceType{0x1000, 0};
inline constexpr ObjectAddress kErrorRegister{0x1001, 0};
inline constexpr ObjectAddress kNewestError{0x1003, 1};
inline constexpr ObjectAddress kGuardTime{0x100C, 0};
inline constexpr ObjectAddress kLifeTimeFactor{0x100D, 0};
inline constexpr ObjectAddress kEmcyCobId{0x1014, 0};
inline constexpr ObjectAddress kConsumerHeartbeat{0x1016, 1};
inline constexpr ObjectAddress kSerialNumber{0x1018, 4};
inline constexpr ObjectAddress kProducerHeartbeat{0x1017, 0};

}  // namespace canopen
