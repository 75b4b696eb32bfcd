#pragma once

#include <cstddef>
#include <cstdint>
#include <map>

namespace canopen {

/// How often a node ended a transfer, by abort code.
class AbortCounts {
 public:
  /// A node that makes codes up does not fill the memory: further ones count as kOther.
  static constexpr std::size_t kMaxCodes = 64;
  static constexpr std::uint32_t kOther = 0xFFFFFFFF;

  /// 0: it carried no code.
  void add(std::uint32_t code) { ++counts_[counts_.size() < kMaxCodes || counts_.contains(code) ? code : kOther]; }
  [[nodiscard]] const std::map<std::uint32_t, std::uint64_t>& by_code() const noexcept { return counts_; }

 private:
  std::map<std::uint32_t, std::uint64_t> counts_;
};

}  // namespace canopen
