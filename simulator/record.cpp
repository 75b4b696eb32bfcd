#include "simulator/record.h"

#include <numeric>

namespace simulator {

void Record::note_nmt(const NmtCommand& command) {
  ++nmt_command_count;
  nmt_commands.push_back(command);
  if (nmt_commands.size() > kKept) {
    nmt_commands.pop_front();
  }
}

void Record::note_refusal(Address address) {
  const bool room = sdo_refusals.size() < kKept || sdo_refusals.contains(address);
  ++sdo_refusals[room ? address : Address{}];
}

std::uint64_t Record::total(const std::map<Address, std::uint64_t>& counts) {
  std::uint64_t sum = 0;
  for (const auto& [address, count] : counts) {
    sum += count;
  }
  return sum;
}

std::uint64_t Record::rpdo_total() const {
  return std::accumulate(rpdos.begin(), rpdos.end(), std::uint64_t{0});
}

}  // namespace simulator
