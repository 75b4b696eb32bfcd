#include "tests/unit/journal/disk.h"

#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "bridges/journal/files.h"

namespace journal {

TemporaryDirectory::TemporaryDirectory() {
  std::string name = (std::filesystem::temp_directory_path() / "journal-test.XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error("no temporary directory");
  }
  path_ = name;
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

FileCalls Disk::calls() {
  FileCalls calls = FileCalls::real();
  calls.write = [state = state_](int descriptor, const char* bytes, std::size_t size) -> ssize_t {
    std::unique_lock lock(state->mutex);
    state->hanging = state->hangs;
    state->changed.notify_all();
    state->changed.wait(lock, [&] { return !state->hangs; });
    state->hanging = false;
    if (state->refusal != 0) {
      const std::size_t now = std::min(size, state->taken);
      state->taken -= now;
      if (now > 0) {
        return ::write(descriptor, bytes, now);
      }
      errno = state->refusal;
      return -1;
    }
    return ::write(descriptor, bytes, size);
  };
  calls.sync = [state = state_](int descriptor) {
    const std::lock_guard lock(state->mutex);
    ++state->syncs;
    errno = state->sync_refusal;
    return state->sync_refusal != 0 ? -1 : fdatasync(descriptor);
  };
  return calls;
}

void Disk::hang() {
  const std::lock_guard lock(state_->mutex);
  state_->hangs = true;
}

void Disk::go_on() {
  const std::lock_guard lock(state_->mutex);
  state_->hangs = false;
  state_->changed.notify_all();
}

void Disk::await_hanging() {
  std::unique_lock lock(state_->mutex);
  state_->changed.wait(lock, [this] { return state_->hanging; });
}

void Disk::refuse(int error, std::size_t bytes) {
  const std::lock_guard lock(state_->mutex);
  state_->refusal = error;
  state_->taken = bytes;
}

void Disk::accept() {
  refuse(0);
}

void Disk::refuse_sync(int error) {
  const std::lock_guard lock(state_->mutex);
  state_->sync_refusal = error;
}

std::size_t Disk::syncs() const {
  const std::lock_guard lock(state_->mutex);
  return state_->syncs;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void set_text(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary | std::ios::trunc) << text;
}

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::istringstream stream(text_of(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

std::vector<std::string> names_in(const std::filesystem::path& directory) {
  std::error_code failure;
  std::vector<std::string> names;
  for (const File& file : list_files(directory, failure)) {
    names.push_back(to_string(file.name));
  }
  return names;
}

Entry entry_at(int day, int hour, const std::string& members) {
  using namespace std::chrono;
  return {sys_days(year(2026) / January / day) + hours(hour), canopen::TimePoint(seconds(5)), members};
}

}  // namespace journal
