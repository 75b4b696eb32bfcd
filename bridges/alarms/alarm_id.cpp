#include "bridges/alarms/alarm_id.h"

#include <sys/random.h>

#include <cerrno>
#include <cstdint>
#include <system_error>

#include "canopen/hex.h"

namespace alarms {

std::string random_id() {
  std::uint64_t number = 0;
  // So few bytes come whole or not at all (getrandom(2)).
  while (getrandom(&number, sizeof number, 0) != static_cast<ssize_t>(sizeof number)) {
    if (errno != EINTR) {
      throw std::system_error(errno, std::generic_category(), "getrandom");
    }
  }
  return canopen::hex(number, 16);
}

}  // namespace alarms
