#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "simulator/cia402_drive.h"
#include "simulator/drive.h"
#include "simulator/goodrive600.h"
#include "simulator/opte6.h"
#include "simulator/veichi.h"

namespace simulator {
namespace {

struct Kind {
  std::string_view name;
  std::unique_ptr<Model> (*make)(const DriveOptions&);
};

constexpr std::array<Kind, 5> kKinds{{
    {"veichi-ac300",
     [](const DriveOptions& options) -> std::unique_ptr<Model> {
       return std::make_unique<Veichi>(VeichiSeries::ac300, options);
     }},
    {"veichi-ac310",
     [](const DriveOptions& options) -> std::unique_ptr<Model> {
       return std::make_unique<Veichi>(VeichiSeries::ac310, options);
     }},
    {"invt-goodrive600",
     [](const DriveOptions& options) -> std::unique_ptr<Model> { return std::make_unique<Goodrive600>(options); }},
    {"vacon-opte6", [](const DriveOptions&) -> std::unique_ptr<Model> { return std::make_unique<Opte6>(); }},
    {"cia402-velocity", [](const DriveOptions&) -> std::unique_ptr<Model> { return std::make_unique<Cia402Drive>(); }},
}};

const Kind* find_kind(std::string_view name) {
  for (const Kind& kind : kKinds) {
    if (kind.name == name) {
      return &kind;
    }
  }
  return nullptr;
}

bool is_node(std::uint8_t node) {
  return node >= 1 && node <= 127;
}

}  // namespace

std::string drive_kinds() {
  std::string list;
  for (const Kind& kind : kKinds) {
    list.append(list.empty() ? "" : ", ").append(kind.name);
  }
  return list;
}

std::string why_no_drive(std::string_view kind, std::uint8_t node) {
  if (find_kind(kind) == nullptr) {
    return "unknown kind of drive \"" + std::string(kind) + "\"; known are " + drive_kinds();
  }
  if (!is_node(node)) {
    return "node " + std::to_string(node) + " is not possible; nodes are 1 to 127";
  }
  return {};
}

std::unique_ptr<Drive> make_drive(std::string_view kind, std::uint8_t node, Network& network,
                                  const DriveOptions& options) {
  const Kind* const found = find_kind(kind);
  if (found == nullptr || !is_node(node)) {
    return nullptr;
  }
  return std::make_unique<Drive>(found->make(options), node, network, options);
}

}  // namespace simulator
