#include <filesystem>
#include <string>
#include <system_error>

#include "bridges/journal/verify.h"
#include "daemon/commands.h"
#include "daemon/descriptors.h"
#include "daemon/journal_place.h"
#include "daemon/output.h"

namespace gateway {
namespace {

std::string count_text(std::uint64_t count, const std::string& what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

std::string text_of(const journal::Report& report, const std::filesystem::path& directory) {
  std::string text;
  for (const std::string& remark : report.remarks) {
    text += (directory / remark).string() + '\n';
  }
  if (report.lost > 0) {
    text += count_text(report.lost, "line") + " could not be written while the disk was full or hung\n";
  }
  if (!report.sound()) {
    return text + (directory / report.broken).string() + '\n';
  }
  text += "ok: " + count_text(report.lines, "line") + " of " + count_text(report.files, "file");
  if (report.lines > 0) {
    text += ", " + report.from + " to " + report.to + "\nnewest: line " + std::to_string(report.newest) + ", SHA-256 " +
            report.newest_hash;
  }
  return text + '\n';
}

}  // namespace

int verify_journal(const Options& options) {
  const std::optional<config::Model> model = load_or_complain(options, Secrets::leave);
  if (!model) {
    return kConfigurationError;
  }
  if (model->gateway.state_dir.empty()) {
    complain("gateway.state_dir is empty: there is no journal");
    return kFailed;
  }
  const std::filesystem::path directory = journal_place(model->gateway).directory;
  std::error_code failure;
  const journal::Report report = journal::verify(directory, failure);
  if (failure) {
    complain(directory.string() + ": " + failure.message());
    return kFailed;
  }
  print(text_of(report, directory));
  return report.sound() ? kDone : kFailed;
}

}  // namespace gateway
