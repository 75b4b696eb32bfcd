#include <fmt/format.h>

#include <stdexcept>

#include "tests/bench/modbus_ceiling.h"
#include "tests/bench/modbus_load.h"
#include "tests/bench/parts.h"
#include "tests/bench/rates.h"
#include "tests/bench/site.h"

namespace bench {

void modbus() {
  const std::uint16_t bare_port = free_port();
  const BareModbusServer bare(bare_port);
  const std::uint16_t gateway_port = free_port();
  SiteInThread site(demo_model(gateway_port, 0));
  if (!site.wait_online()) {
    throw std::runtime_error("the simulated drives did not come online");
  }
  const std::uint8_t unit = *site.model().drives.front().unit;
  for (const int clients : {1, 8}) {
    print(compare(
        fmt::format("Modbus, function 3, 10 registers, {} client{}", clients, clients == 1 ? "" : "s"), "requests/s", 5,
        [&] { return requests_per_second({.port = bare_port, .unit = 1, .clients = clients}); },
        [&] { return requests_per_second({.port = gateway_port, .unit = unit, .clients = clients}); }));
  }
}

}  // namespace bench
