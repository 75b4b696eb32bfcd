// Commands as a broker brings them to a plant with a live drive: topic, payload, response topic, correlation data,
// expiry and flags are the input's. Whatever they are: each command is answered once, in JSON, where answers may go;
// what must not be carried out leaves the bus alone; a stop reaches the drive and is no repetition.
//
// An input is a row of messages with 0x1E between them; each is a row of fields with 0x1F between them: options, topic,
// payload, response topic, correlation data. Options are letters: r retained, d redelivered, c has correlation data,
// e nothing left of its expiry, x two seconds left, o the next one does not wait for the answer, q the drive answers
// nothing meanwhile. A topic that begins with `B/` is one of the gateway.

#include <algorithm>
#include <array>
#include <boost/json/parse.hpp>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/mqtt/requests.h"
#include "bridges/mqtt/topics.h"
#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/puppet.h"
#include "tests/support/spawn.h"
#include "tests/unit/mqtt/site.h"

namespace {

using namespace std::chrono_literals;
using mqtt::Incoming;
using mqtt::Message;

constexpr char kBetweenMessages = '\x1E';
constexpr char kBetweenFields = '\x1F';
// More would test patience only.
constexpr std::size_t kMaxMessages = 16;
constexpr std::string_view kBase = "canopen/";
const std::string kRoot = "canopen/line3/";

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

std::string take_until(std::string_view& rest, char end) {
  const std::size_t length = std::min(rest.find(end), rest.size());
  std::string taken(rest.substr(0, length));
  rest.remove_prefix(std::min(length + 1, rest.size()));
  return taken;
}

std::string topic_of(std::string text) {
  return text.starts_with("B/") ? kRoot + text.substr(2) : text;
}

struct Brought {
  Incoming message;
  bool waits = true;
  bool drive_is_mute = false;
};

Brought brought_by(std::string_view text) {
  Brought brought;
  const std::string options = take_until(text, kBetweenFields);
  const auto has = [&options](char option) { return options.find(option) != std::string::npos; };
  Incoming& message = brought.message;
  message.topic = topic_of(take_until(text, kBetweenFields));
  message.payload = take_until(text, kBetweenFields);
  message.response_topic = topic_of(take_until(text, kBetweenFields));
  if (has('c')) {
    message.correlation = std::string(text);
  }
  message.retained = has('r');
  message.redelivered = has('d');
  if (has('e') || has('x')) {
    message.expiry = has('e') ? 0 : 2;
  }
  brought.waits = !has('o');
  brought.drive_is_mute = has('q');
  return brought;
}

// `pump1` takes commands by MQTT, 5 stops it; `fan1` takes none.
config::Model site_model() {
  config::Model model = mqtt::test::model();
  config::Drive& pump = model.drives[0];
  pump.node.error_control.policy = canopen::SetupPolicy::assume;
  pump.signals[mqtt::test::kCounter].access = config::Access::write;
  pump.faults.has_error_field = false;
  pump.node.motor.control = canopen::ObjectAddress{0x2000, 1};
  pump.node.motor.stops = {{.equals = 5}};
  pump.commands.raw = true;
  config::Drive fan = pump;
  fan.name = "fan1";
  fan.node.node = 6;
  fan.node.tpdos[0].cob_id = 0x186;
  fan.node.rpdos[0].cob_id = 0x206;
  fan.commands.writers = {};
  model.drives.push_back(fan);
  model.mqtt->answers = {"app/#"};
  return model;
}

/// What stands in an answer, as far as it is looked at here.
struct Told {
  bool ok = false;
  std::string code;
};

Told read_answer(const std::string& payload) {
  const boost::json::value read = boost::json::parse(payload);  // throws where it is no JSON
  const boost::json::object& object = read.as_object();
  Told told{.ok = object.at("ok").as_bool(), .code = {}};
  if (!told.ok) {
    told.code = std::string(object.at("code").as_string());
    require(!object.at("error").as_string().empty());
  }
  return told;
}

// What a drive was told.
std::size_t effects_on(const support::Puppet& drive) {
  return drive.rpdos.size() + drive.written.size() + drive.nmt_commands.size();
}

void fill(support::Puppet& drive) {
  drive.dictionary = {{{0x1017, 0}, {500, 2}}, {{0x1001, 0}, {0, 1}}, {{0x2021, 1}, {0, 2}},     {{0x2021, 2}, {0, 2}},
                      {{0x2021, 3}, {3, 1}},   {{0x2021, 4}, {0, 2}}, {{0x2000, 1}, {0, 2}},     {{0x2000, 2}, {0, 2}},
                      {{0x2031, 0}, {0, 1}},   {{0x2032, 0}, {1, 1}}, {{0x2002, 3}, {0x1234, 2}}};
}

class Site {
 public:
  Site();
  ~Site();
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;

  void bring(Brought brought);
  /// Time passes until every command is answered; nothing may have reached the drive that takes none.
  void drain();

 private:
  void pass(canopen::Duration time);
  void end(boost::asio::awaitable<void> stop);
  void published(const Message& message);
  [[nodiscard]] bool online() { return plant_.drive(0).status().online; }
  void look_at(const Incoming& message, std::size_t effects_before, bool was_online);

  support::HandDrivenLoop loop_;
  config::Model model_ = site_model();
  canopen::VirtualBus can_{loop_.executor()};
  support::Puppet pump_{can_, 5};
  support::Puppet fan_{can_, 6};
  canopen::Bus bus_{loop_.executor(), can_.connect(), {.bitrate = 250000, .node_id = 127, .heartbeat = {}, .sync = {}}};
  process::Plant plant_{loop_.executor(), model_, {{&bus_, [this] { return bus_.statistics(); }}}};
  mqtt::Topics topics_{model_, *model_.mqtt, "line3"};
  std::vector<mqtt::Subscription> subscriptions_ = topics_.command_subscriptions();
  std::size_t fan_was_told_ = 0;              ///< By its start.
  std::vector<std::string> response_topics_;  ///< That were named.
  std::vector<std::string> retained_;         ///< Topics of retained commands.
  std::size_t commands_ = 0;                  ///< That are to be answered.
  std::vector<Message> answers_;
  mqtt::Requests requests_{loop_.executor(), plant_, topics_, [this](const Message& message) { published(message); }};
};

Site::Site() {
  fill(pump_);
  fill(fan_);
  bus_.start();
  plant_.start();
  loop_.settle();
  plant_.set_bus_state(0, bus_.state());
  pump_.boot_up();
  fan_.boot_up();
  pass(300ms);
  require(plant_.online() == 2);
  fan_was_told_ = effects_on(fan_);
}

Site::~Site() {
  end(requests_.stop(3s));
  end(plant_.stop());
  end(bus_.stop());
}

void Site::end(boost::asio::awaitable<void> stop) {
  const auto done = support::spawn(loop_.executor(), std::move(stop));
  require(loop_.advance_until([&done] { return *done; }, 5s));
}

void Site::pass(canopen::Duration time) {
  for (canopen::Duration passed{}; passed < time; passed += 50ms) {
    pump_.heartbeat();
    fan_.heartbeat();
    pump_.tpdo(1, std::array<std::uint8_t, 7>{});
    fan_.tpdo(1, std::array<std::uint8_t, 7>{});
    loop_.advance(50ms, 10ms);
  }
}

void Site::published(const Message& message) {
  if (message.kind != mqtt::MessageKind::answer) {
    // Nothing else is published but that a retained command's topic is emptied.
    require(message.retained && message.payload.empty());
    require(std::ranges::find(retained_, message.topic) != retained_.end());
    return;
  }
  require(!message.retained);
  const bool ours = message.topic == kRoot + "result" || message.topic == kRoot + "pump1/sdo/response" ||
                    message.topic == kRoot + "fan1/sdo/response";
  if (!ours) {
    require(std::ranges::find(response_topics_, message.topic) != response_topics_.end());
    require(message.topic == "app" || message.topic.starts_with("app/"));
    require(!message.topic.starts_with(kBase) && message.topic.find_first_of("+#") == std::string::npos);
  }
  (void)read_answer(message.payload);
  answers_.push_back(message);
}

void Site::drain() {
  for (canopen::Duration passed{}; passed < 5s && answers_.size() < commands_; passed += 50ms) {
    pass(50ms);
  }
  require(answers_.size() == commands_);
  require(effects_on(fan_) == fan_was_told_);
}

void Site::bring(Brought brought) {
  Incoming& message = brought.message;
  message.received = canopen::Clock::now();
  const auto route = topics_.route(message.topic);
  const bool subscribed = std::ranges::any_of(
      subscriptions_, [&message](const auto& each) { return mqtt::matches(each.filter, message.topic); });
  if (!subscribed) {
    return;  // no broker brings it
  }
  require(route.has_value());
  if (message.retained) {
    drain();
    retained_.push_back(message.topic);
  }
  response_topics_.push_back(message.response_topic);
  const std::size_t before = effects_on(pump_);
  const bool was_online = online();
  pump_.mute = brought.drive_is_mute;
  commands_ += route->kind != mqtt::Route::Kind::alive && !message.payload.empty() ? 1 : 0;
  const bool alone = answers_.size() + 1 == commands_;
  requests_.handle(message, *route);
  if (brought.waits || message.retained) {
    drain();
    pump_.mute = false;
    if (alone) {
      look_at(message, before, was_online && !brought.drive_is_mute);
    }
    pass(route->kind == mqtt::Route::Kind::nmt ? 1500ms : 50ms);  // a drive that was reset is started again
  }
}

void Site::look_at(const Incoming& message, std::size_t effects_before, bool was_online) {
  const Message& answer = answers_.back();
  const Told told = read_answer(answer.payload);
  const bool moved = effects_on(pump_) != effects_before;
  require(answer.correlation == message.correlation);
  require(message.retained == (told.code == "retained"));
  if (message.retained || message.expiry == 0U) {
    require(!moved && (!told.ok || message.topic.ends_with("/sdo/request")));
    return;
  }
  require(!moved || told.code != "duplicate");
  const bool plainly_stops = message.topic == kRoot + "stop" ||
                             (message.topic == kRoot + "pump1/control_command/set" && message.payload == "5");
  require(!plainly_stops || requests_.is_stop(message));
  if (requests_.is_stop(message)) {
    require(told.code != "duplicate" && told.code != "forbidden" && told.code != "lease");
    // A stop value that is written as an object of another type is refused, as any such value.
    require(moved || !was_online || (!plainly_stops && told.code == "type"));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  std::string_view rest = text;
  Site site;
  for (std::size_t i = 0; i < kMaxMessages && !rest.empty(); ++i) {
    site.bring(brought_by(take_until(rest, kBetweenMessages)));
  }
  site.drain();
  return 0;
}
