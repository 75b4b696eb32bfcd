#include "bridges/mqtt/bridge.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/error_code.hpp>
#include <exception>
#include <utility>

#include "bridges/mqtt/info.h"

namespace mqtt {
namespace {

using canopen::kNever;
// Longer than the usual deadline of a command.
constexpr canopen::Duration kCommandPatience = std::chrono::seconds(2);
// Numbers wait so long for company behind a batch: to wake other threads for each frame of a busy bus costs more than
// all else that is done with a value.
constexpr canopen::Duration kCompany = std::chrono::milliseconds(4);

bool is_value(const Message& message) {
  return message.kind == MessageKind::value;
}

}  // namespace

Bridge::Bridge(boost::asio::any_io_executor executor, process::Plant& plant, const config::Mqtt& settings,
               const config::Gateway& gateway, std::string version, std::string instance,
               std::unique_ptr<Broker> broker, Notice notice)
    : plant_(plant),
      settings_(settings),
      version_(std::move(version)),
      broker_(std::move(broker)),
      notice_(std::move(notice)),
      topics_(plant.model(), settings_, gateway.name),
      session_(*broker_, topics_, notice_),
      requests_(executor, plant, topics_, [this](Message message) { publish(std::move(message)); }),
      alarms_(plant, topics_),
      status_(topics_.status(), settings_, true),
      health_(topics_.health(), settings_),
      leftovers_(plant.model(), settings_, topics_),
      home_assistant_(plant.model(), settings_, topics_, leftovers_, version_),
      other_(std::move(instance), settings_, notice_,
             [this] {
               plant_.set_other_gateway(other_.lives());
               health_may_differ();
             }),
      next_(kNever),
      executor_(std::move(executor)),
      timer_(executor_),
      wake_at_(kNever),
      ended_(executor_) {
  feeds_.reserve(plant.size());
  for (std::size_t i = 0; i < plant.size(); ++i) {
    feeds_.emplace_back(plant.drive(i), topics_.drive(i), settings_);
  }
}

Bridge::~Bridge() {
  broker_.reset();  // its threads ask is_stop() until then
}

void Bridge::start() {
  running_ = true;
  boost::asio::co_spawn(executor_, run(), [this](std::exception_ptr failure) {
    if (failure) {
      std::rethrow_exception(failure);
    }
    running_ = false;
    ended_.cancel();
  });
  broker_->start(*this);
}

boost::asio::awaitable<void> Bridge::stop() {
  co_await requests_.stop(kCommandPatience);
  stopping_ = true;
  timer_.cancel();
  boost::system::error_code ignored;
  if (running_) {
    ended_.expires_at(kNever);
    co_await ended_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, ignored));
  }
  co_await broker_->stop(last_words());
  session_.lost();
  follow_session();
}

std::vector<Message> Bridge::last_words() {
  std::vector<Message> last = std::exchange(batch_, {});
  if (session_.ready()) {
    alarms_.collect_last(last);
  }
  for (const Feed& feed : feeds_) {
    feed.collect_last(last);
  }
  last.push_back(status_.offline());
  return last;
}

void Bridge::on_values(const process::Drive& drive, std::span<const process::SignalId> signals) {
  if (session_.ready()) {
    Feed& feed = feeds_[drive.index()];
    const canopen::TimePoint now = canopen::Clock::now();
    const canopen::TimePoint due = feed.mark_values(signals, now);
    urgent_ = urgent_ || due == kAtOnce;
    come_again(std::max(due, now));
    if (feed.must_not_wait()) {  // the next frame of this turn may take it back
      feed.collect(now, batch_);
    }
  }
}

void Bridge::on_freshness(const process::Drive& drive, std::span<const process::SignalId> signals) {
  on_values(drive, signals);
}

void Bridge::on_commanded(const process::Drive&, std::span<const process::SignalId>) {
  // What was commanded is on no topic; its effect comes back as values.
}

void Bridge::on_control(const process::Drive& drive) {
  if (session_.ready()) {
    wake(feeds_[drive.index()].mark_control(canopen::Clock::now()));
  }
}

void Bridge::on_status(const process::Drive& drive) {
  if (session_.ready()) {
    wake(feeds_[drive.index()].mark_status(canopen::Clock::now()));
    health_may_differ();
  }
}

void Bridge::on_bus(std::size_t /*bus*/) {
  health_may_differ();
}

void Bridge::on_alarm(const process::Drive& drive, alarms::AlarmKind kind) {
  if (session_.ready()) {
    wake(alarms_.mark(drive, kind, canopen::Clock::now()));
  }
}

void Bridge::on_bus_alarm(std::size_t bus) {
  if (session_.ready()) {
    wake(alarms_.mark_bus(bus, canopen::Clock::now()));
  }
}

void Bridge::health_may_differ() {
  if (session_.ready()) {
    wake(health_.mark(canopen::Clock::now()));
  }
}

boost::asio::awaitable<void> Bridge::run() {
  boost::system::error_code ignored;
  while (!stopping_) {
    wake_at_ = turn();
    timer_.expires_at(wake_at_);
    co_await timer_.async_wait(boost::asio::redirect_error(boost::asio::use_awaitable, ignored));
  }
  turn();
}

canopen::TimePoint Bridge::turn() {
  const canopen::TimePoint now = canopen::Clock::now();
  session_.tick(now);
  other_.tick(now);
  follow_session();
  const canopen::TimePoint leaves = leave_if_ready(now);
  if (session_.ready()) {
    collect(now);
  } else {
    next_ = kNever;
  }
  if (std::exchange(urgent_, false) || now - sent_at_ >= kCompany || !std::ranges::all_of(batch_, is_value)) {
    send_batch(now);
  }
  const canopen::TimePoint company = batch_.empty() ? kNever : sent_at_ + kCompany;
  return std::min({next_, session_.deadline(), other_.next(), leaves, company});
}

void Bridge::announce() {
  batch_.push_back(info());
  for (Feed& feed : feeds_) {
    feed.mark_all();
  }
  alarms_.mark_all();
  health_.forget();
  status_.forget();
  const canopen::TimePoint now = canopen::Clock::now();
  leftovers_.announced(now);
  home_assistant_.announced(now);
  collect(now);
  send_batch(now);
  broker_->open(session_.connection());
}

Message Bridge::info() const {
  return {.topic = topics_.info(), .payload = info_json(plant_.model(), topics_, version_, other_.instance())};
}

void Bridge::send_batch(canopen::TimePoint now) {
  if (batch_.empty() || stopping_) {
    return;
  }
  put_right_.note(batch_, now, notice_);
  broker_->publish(std::exchange(batch_, {}));
  sent_at_ = now;
}

void Bridge::collect(canopen::TimePoint now) {
  next_ = alarms_.collect(now, batch_);
  for (Feed& feed : feeds_) {
    next_ = std::min(next_, feed.collect(now, batch_));
  }
  if (health_.next() <= now) {
    process::Health health = process::health_of(plant_);
    health.instance = other_.instance();
    health.broker = broker_health();
    if (program_health_) {
      health.program = program_health_();
    }
    health_.collect(std::move(health), now, batch_);
  }
  status_.collect(true, now, batch_);  // last: it says that all else is there
  leftovers_.collect(other_.lives(), now, batch_, notice_);
  home_assistant_.collect(other_.lives(), now, batch_);
  next_ = std::min({next_, health_.next(), status_.next(), leftovers_.next(), home_assistant_.next()});
}

void Bridge::follow_session() {
  if (session_.ready() == was_connected_) {
    return;
  }
  was_connected_ = session_.ready();
  if (was_connected_) {
    other_.listening(canopen::Clock::now());
    announce();
  }
  wake(canopen::Clock::now());
  if (connected_change_) {
    connected_change_(was_connected_);
  }
}

void Bridge::wake(canopen::TimePoint at) {
  urgent_ = true;
  come_again(at);
}

void Bridge::come_again(canopen::TimePoint at) {
  if (at < wake_at_) {
    wake_at_ = at;
    timer_.expires_at(at);  // run() goes on when its wait is cancelled
  }
}

void Bridge::publish(Message message) {
  batch_.push_back(std::move(message));
  wake(canopen::Clock::now());
}

}  // namespace mqtt
