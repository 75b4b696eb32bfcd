#include "daemon/http/respond.h"

namespace gateway::http {

Answer map(const Site& site) {
  return {.lasting = site.map.get(), .shared = site.map};
}

}  // namespace gateway::http
