#pragma once

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "bridges/alarms/alarm_memory.h"
#include "bridges/alarms/memory_file.h"

namespace alarms {

/// A state directory that is gone with the test, on a real disk that a test makes hang and refuse.
class MemoryBench {
 public:
  MemoryBench() {
    std::string name = (std::filesystem::temp_directory_path() / "memory-test.XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error("no temporary directory");
    }
    root_ = name;
  }
  ~MemoryBench() {
    go_on();
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }
  MemoryBench(const MemoryBench&) = delete;
  MemoryBench& operator=(const MemoryBench&) = delete;

  [[nodiscard]] std::filesystem::path state() const { return root_ / "state"; }
  [[nodiscard]] std::filesystem::path file() const { return state() / MemoryFile::kName; }
  [[nodiscard]] std::filesystem::path bad() const { return state() / MemoryFile::kBadName; }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(state())) {
      names.push_back(entry.path().filename().string());
    }
    std::ranges::sort(names);
    return names;
  }
  static std::string text_of(const std::filesystem::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void put(const std::string& text) const {
    std::filesystem::create_directory(state());
    std::ofstream(file()) << text;
  }

  /// What refuses; the others work.
  enum class Call { none, read, write, sync, rename };
  [[nodiscard]] MemoryCalls calls() {
    const MemoryCalls real = MemoryCalls::real();
    return {.read = [state = state_](int file, char* bytes, std::size_t size) -> ssize_t {
              return state->refuses(Call::read) ? -1 : ::read(file, bytes, size);
            },
            .write = [state = state_](int file, const char* bytes, std::size_t size) -> ssize_t {
              // As a disk that becomes full: a part is taken.
              const std::size_t part = state->refuses(Call::write) ? std::exchange(state->taken, 0) : size;
              if (part == 0) {
                errno = state->error;
                return -1;
              }
              return ::write(file, bytes, std::min(size, part));
            },
            .sync = [state = state_](int file) { return state->refuses(Call::sync) ? -1 : fsync(file); },
            .rename = [state = state_](
                          const char* from,
                          const char* to) { return state->refuses(Call::rename) ? -1 : std::rename(from, to); }};
  }
  void refuse(Call call, int error, std::size_t taken = 0) {
    const std::lock_guard lock(state_->mutex);
    state_->refused = call;
    state_->error = error;
    state_->taken = taken;
  }
  void accept() { refuse(Call::none, 0); }
  void hang() {
    const std::lock_guard lock(state_->mutex);
    state_->hangs = true;
  }
  void go_on() {
    const std::lock_guard lock(state_->mutex);
    state_->hangs = false;
    state_->changed.notify_all();
  }
  void await_hanging() {
    std::unique_lock lock(state_->mutex);
    state_->changed.wait(lock, [this] { return state_->hanging; });
  }

 private:
  struct State {
    std::mutex mutex;
    std::condition_variable changed;
    bool hangs = false;
    bool hanging = false;
    Call refused = Call::none;
    int error = 0;
    std::size_t taken = 0;

    bool refuses(Call call) {
      std::unique_lock lock(mutex);
      hanging = hangs;
      changed.notify_all();
      changed.wait(lock, [this] { return !hangs; });
      hanging = false;
      errno = error;
      return refused == call;
    }
  };
  std::filesystem::path root_;
  std::shared_ptr<State> state_ = std::make_shared<State>();  ///< With the calls, which a thread may outlive us with.
};

/// Something to keep: `count` tells one from another.
inline AlarmMemory memory_with(std::uint32_t count) {
  Alarm alarm;
  alarm.active = true;
  alarm.known = true;
  alarm.id = "00FF00FF00FF00FF";
  alarm.code = 0x2310;
  alarm.text = "Overcurrent";
  alarm.since = canopen::WallTime(std::chrono::seconds(5));
  alarm.ts = canopen::WallTime(std::chrono::seconds(6));
  alarm.count = count;
  alarm.first = true;
  alarm.record = "20260102T030405.678Z-pump1-emcy.log";
  alarm.errors = {{0x2310, {1, 2}, "Overcurrent", config::Severity::fault, alarm.since}};
  Alarm over = alarm;
  over.active = false;
  over.cleared = canopen::WallTime(std::chrono::seconds(9));
  over.errors.clear();
  AlarmMemory memory;
  memory.gateway = "line3";
  AlarmMemory::OfDrive& pump = memory.drives.emplace_back();
  pump.name = "pump1";
  pump.alarms.at(0) = alarm;
  pump.alarms.at(4) = over;
  memory.drives.emplace_back().name = "fan 2";
  memory.buses.push_back({"can0", over});
  memory.newest_first = NamedFault{"pump1", "", AlarmKind::emcy};
  return memory;
}

}  // namespace alarms
