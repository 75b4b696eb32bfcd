#include "bridges/process/drive.h"

#include <utility>

#include "bridges/process/drive_body.h"

namespace process {

using boost::asio::awaitable;

Drive::Drive(boost::asio::any_io_executor executor, const config::Drive& model, std::size_t index, canopen::Bus& bus,
             const std::vector<Observer*>& observers)
    : body_(std::make_unique<Body>(executor, model, index, bus, observers, *this)) {}

Drive::~Drive() = default;

void Drive::start() {
  body_->start();
}

void Drive::close() {
  body_->close();
}

awaitable<void> Drive::stop() {
  return body_->stop();
}

const config::Drive& Drive::model() const noexcept {
  return body_->model();
}

std::size_t Drive::index() const noexcept {
  return body_->index();
}

const Image& Drive::image() const noexcept {
  return body_->image();
}

const canopen::NodeStatus& Drive::status() const noexcept {
  return body_->status();
}

const Alarm& Drive::alarm(AlarmKind kind) const noexcept {
  return std::as_const(*body_).alarms().alarm(kind);
}

bool Drive::has_fault_alarm() const noexcept {
  return std::as_const(*body_).alarms().any(config::Severity::fault);
}

bool Drive::has_warning_alarm() const noexcept {
  return std::as_const(*body_).alarms().any(config::Severity::warning);
}

awaitable<Outcome> Drive::write(Writer writer, std::vector<FieldWrite> fields, StillStands still_stands) {
  return body_->commands().write(std::move(writer), std::move(fields), std::move(still_stands));
}

awaitable<Outcome> Drive::nmt(Writer writer, canopen::NmtCommand command) {
  return body_->commands().nmt(std::move(writer), command);
}

awaitable<canopen::Result<canopen::Raw>> Drive::sdo_read(canopen::ObjectAddress object, canopen::DataType type) {
  return body_->commands().sdo_read(object, type);
}

awaitable<Outcome> Drive::sdo_write(Writer writer, canopen::ObjectValue value) {
  return body_->commands().sdo_write(std::move(writer), value);
}

void Drive::restore_emcy(const Alarm& alarm) {
  body_->alarms().restore_emcy(alarm);
}

}  // namespace process
