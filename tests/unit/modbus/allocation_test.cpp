#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

#include "tests/unit/modbus/site.h"

namespace {

// Of this thread.
thread_local std::size_t allocations = 0;

}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) {
    return memory;
  }
  throw std::bad_alloc();
}
// Asio takes memory for coroutines and operations from here.
extern "C" void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  void* memory = nullptr;
  return ::posix_memalign(&memory, alignment, size) == 0 ? memory : nullptr;
}
void* operator new(std::size_t size, const std::nothrow_t& /*quietly*/) noexcept {
  ++allocations;
  return std::malloc(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}

namespace {

using modbus_test::Bytes;
using modbus_test::frame;
using modbus_test::kUnit;
using modbus_test::Site;
using modbus_test::TcpClient;

TEST(Allocation, ReadsAreAnsweredWithoutAllocation) {
  Site site;
  site.bring_up();
  TcpClient& client = site.client();
  const Bytes request = frame(kUnit, "03 0000 000d");
  std::vector<std::size_t> counts;
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(client.send(request), request.size());
    const std::size_t before = allocations;
    site.settle();
    counts.push_back(allocations - before);
    EXPECT_EQ(site.answer(client).substr(0, 5), "03 1a");
  }
  // The first ones fill Asio's per-thread store.
  for (std::size_t i = 5; i < counts.size(); ++i) {
    EXPECT_EQ(counts[i], 0U) << i;
  }
  // What counts does count.
  const std::size_t before = allocations;
  void* volatile aligned = std::aligned_alloc(16, 64);
  std::free(aligned);
  EXPECT_EQ(allocations, before + 1);
}

}  // namespace
