#include "daemon/http/respond.h"

namespace gateway::http {

Answer health(const Site& site) {
  const process::Health health = site.health();
  return {.status = process::is_well(health) ? 200U : 503U, .body = process::health_json(health)};
}

}  // namespace gateway::http
