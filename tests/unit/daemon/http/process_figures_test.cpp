#include "daemon/http/process_figures.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>

namespace gateway::http {
namespace {

TEST(HttpProcessFigures, AreThoseOfThisProcess) {
  const ProcessFigures figures = process_figures();
  EXPECT_GT(figures.resident_bytes, 1'000'000U);
  EXPECT_GE(figures.virtual_bytes, figures.resident_bytes);
  EXPECT_GT(figures.max_descriptors, 3U);
  EXPECT_GE(figures.cpu_seconds, 0.0);
  const double now = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  EXPECT_LE(figures.start_time, now + 0.1);
  EXPECT_GT(figures.start_time, now - 24.0 * 3600.0);
  const int descriptor = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  EXPECT_EQ(process_figures().open_descriptors, figures.open_descriptors + 1);
  ::close(descriptor);
}

}  // namespace
}  // namespace gateway::http
