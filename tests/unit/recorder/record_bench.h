#pragma once

#include <stdlib.h>
#include <sys/file.h>
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
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bridges/recorder/record.h"
#include "bridges/recorder/whole_file.h"
#include "tests/support/frame.h"

namespace recorder {

/// A state directory that is gone with the test, on a real disk that a test makes hang and refuse.
class RecordBench {
 public:
  RecordBench() {
    std::string name = (std::filesystem::temp_directory_path() / "record-test.XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error("no temporary directory");
    }
    root_ = name;
  }
  ~RecordBench() {
    go_on();
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }
  RecordBench(const RecordBench&) = delete;
  RecordBench& operator=(const RecordBench&) = delete;

  [[nodiscard]] std::filesystem::path state() const { return root_ / "state"; }
  [[nodiscard]] std::filesystem::path records() const { return state() / "records"; }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(records(), none)) {
      names.push_back(entry.path().filename().string());
    }
    std::ranges::sort(names);
    return names;
  }
  [[nodiscard]] std::string text_of(const std::string& name) const {
    std::ifstream stream(records() / name);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void put(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(records());
    std::ofstream(records() / name) << text;
  }

  /// A file where the directory of the records is to be.
  void put_in_the_way() const {
    std::filesystem::create_directories(state());
    std::ofstream(records()) << "x";
  }
  void clear_the_way() const { std::filesystem::remove(records()); }

  /// What refuses; the others work.
  enum class Call { none, write, sync, rename, remove };
  [[nodiscard]] DiskCalls calls() {
    return {.write = [state = state_](int file, const char* bytes, std::size_t size) -> ssize_t {
              // As a disk that becomes full: a part is taken.
              const std::size_t part = state->refuses(Call::write) ? std::exchange(state->taken, 0) : size;
              if (part == 0) {
                errno = state->error;
                return -1;
              }
              return ::write(file, bytes, std::min(size, part));
            },
            // Nothing here asks what a power failure leaves, and the machine's disk may take its time.
            .sync = [state = state_](int) { return state->refuses(Call::sync) ? -1 : 0; },
            .rename =
                [state = state_](int directory, const char* from, const char* to) {
                  return state->refuses(Call::rename) ? -1 : ::renameat(directory, from, directory, to);
                },
            .remove = [state = state_](int directory, const char* name) { return state->remove(directory, name); },
            // The machine's own disk is nobody's business.
            .space = [state = state_](int) { return state->space_left(); }};
  }
  void set_space(DiskCalls::Space space) {
    const std::lock_guard lock(state_->mutex);
    state_->space = space;
  }
  /// What refuses does so until a file is removed.
  void accept_when_removed() {
    const std::lock_guard lock(state_->mutex);
    state_->accepts_when_removed = true;
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
    std::optional<DiskCalls::Space> space;
    bool accepts_when_removed = false;

    std::optional<DiskCalls::Space> space_left() {
      const std::lock_guard lock(mutex);
      return space;
    }
    int remove(int directory, const char* name) {
      if (refuses(Call::remove)) {
        return -1;
      }
      const std::lock_guard lock(mutex);
      refused = accepts_when_removed ? Call::none : refused;
      return ::unlinkat(directory, name, 0);
    }
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

/// 2026-01-02T03:04:05Z and so many seconds.
inline canopen::WallTime wall_at(int seconds) {
  return canopen::WallTime(std::chrono::seconds(1767323045 + seconds));
}

inline canopen::Received received(std::uint32_t id, int seconds, std::uint8_t content = 0) {
  return {support::frame(id, content), canopen::TimePoint(std::chrono::seconds(3600 + seconds)), wall_at(seconds)};
}

/// A record of `frames` frames, one a second; `seconds` tells one from another.
inline Record record_of(int seconds, int frames = 3, bool first = false, std::size_t bus = 0) {
  FrameRing ring(std::chrono::minutes(10), 100'000);
  for (int i = 0; i < frames; ++i) {
    ring.on_frame(received(0x185, seconds + i, static_cast<std::uint8_t>(i)), canopen::FrameOrigin::others);
  }
  Record record{.name = {wall_at(seconds), "pump1", "emcy"}, .bus = "can" + std::to_string(bus), .interface = "can0"};
  record.drive = "pump1";
  record.from = wall_at(seconds);
  record.until = wall_at(seconds + frames);
  record.frames = ring.slice(canopen::TimePoint(std::chrono::seconds(3600)), canopen::TimePoint::max());
  alarms::Alarm alarm;
  alarm.active = alarm.known = true;
  alarm.id = "00FF00FF00FF00FF";
  alarm.count = 1;
  alarm.first = first;
  alarm.errors = {{0x2310, {1, 2}, "Overcurrent", config::Severity::fault, wall_at(seconds)}};
  record.alarms.push_back({"pump1", alarms::AlarmKind::emcy, alarm, alarm});
  record.commands = {R"({"writer":"local"})"};
  return record;
}

inline std::string stem_of(int seconds) {
  return to_text({wall_at(seconds), "pump1", "emcy"});
}

}  // namespace recorder
