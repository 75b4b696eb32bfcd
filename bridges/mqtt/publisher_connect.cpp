// The turn of one broker: look up its name, try its addresses, serve the connection that comes about.

#include <algorithm>
#include <utility>

#include "bridges/mqtt/password.h"
#include "bridges/mqtt/publisher.h"
#include "bridges/mqtt/reasons.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;

constexpr auto kLookUpCheck = 50ms;
// Beyond connect_timeout, by which Paho gives up, but not at once.
constexpr auto kPahoDelay = 2s;
// Where there is another broker, which is to be in use 10 s after this one fell silent: for all addresses of a name
// together, and for each of them. When all were tried in vain they have all the time that one alone has.
constexpr auto kNameAge = 30s;
constexpr auto kLongNamePatience = 10s;
constexpr auto kTurnPatience = 6000ms;
constexpr auto kShortestPatience = 1000ms;
// For the cause why TLS fails, after an attempt that took as long as it may: it is told within 10 s.
constexpr auto kTlsPatience = 3s;
constexpr auto kTlsPatienceOfSeveral = 1s;

}  // namespace

Publisher::Turn Publisher::take_turn() {
  Attempts& attempts = candidate().attempts;
  if (attempts.wants_addresses()) {
    find_addresses();
  }
  Turn turn{.end = {.why = candidate().look_up.runs() ? "nothing is known of its name yet"
                                                      : "the name " + candidate().broker.host + " has no address"}};
  while (!attempts.wants_addresses() && !turn.stood && !is_finishing()) {
    drop_client();
    const std::string address = attempts.next_address();
    Turn next = attempt(address);
    if (!next.stood && is_one_of_several() && attempts.is_undecided(address)) {
      drop_client();
      next = attempt(address);
    }
    if (next.stood || !turn.end.stays) {
      turn = std::move(next);
    }
  }
  return turn;
}

void Publisher::find_addresses() {
  Candidate& asked = candidate();
  {
    const Guard lock(mutex_);
    expect_sign_of_life(is_one_of_several() ? settings_.silence : settings_.resolve_patience);
  }
  // One that is asked for still is not asked for again; what was true a while ago may not be any more.
  asked.look_up.forget_older(kNameAge);
  if (!asked.look_up.runs()) {
    (void)asked.look_up.start([resolver = settings_.resolver, broker = asked.broker] { return resolver(broker); });
  }
  const bool hurries = is_one_of_several() && rotation_.is_first_round();
  const auto end = Clock::now() + std::chrono::milliseconds(hurries ? settings_.hurried : kLongNamePatience);
  std::optional<std::vector<std::string>> found;
  while (!found && asked.look_up.runs() && !is_finishing() && !(is_one_of_several() && Clock::now() > end)) {
    found = asked.look_up.take(kLookUpCheck);
  }
  asked.resolved = found.value_or(std::vector<std::string>());
  // With TLS Paho gets the name, which the certificate must be for, and takes the address that the system gives.
  const bool named = asked.broker.tls && !asked.resolved.empty();
  asked.attempts.found(named ? std::vector<std::string>{asked.broker.host} : asked.resolved);
}

Publisher::Turn Publisher::attempt(const std::string& address) {
  Candidate& tried = candidate();
  for (std::optional<int> version = tried.attempts.first_version(); version;) {
    const std::optional<Refusal> refusal = connect(address, *version);
    if (!refusal) {
      tell_connected(address, *version);
    }
    version = tried.attempts.next_version(address, *version, refusal);
    if (!refusal) {
      return serve();
    }
    if (!version) {
      return {.end = {.why = text_of(*refusal), .stays = refuses_credentials(refusal->code)},
              .to_mend = !refusal->why.empty()};
    }
    drop_client();
  }
  return {};
}

void Publisher::tell_connected(const std::string& address, int version) {
  const Candidate& now = candidate();
  const bool one_of_several = now.attempts.addresses() > 1;
  say(Level::info, "MQTT: connected to " + now.name + (one_of_several ? " at " + address : "") +
                       (version == 5 ? ", MQTT 5" : ", MQTT 3.1.1") + (now.broker.tls ? ", TLS" : ""));
  Connected connected{.id = line_.connection, .version = version, .broker = now.name};
  if (!now.broker.tls) {
    connected.address = address;
  }
  if (const std::string place = place_of(connected); place != last_place_) {
    const Guard lock(mutex_);
    traffic_.change_broker();
    last_place_ = place;
  }
  loop_->post([this, told = std::move(connected)] { events_->on_connected(told); });
}

std::optional<Refusal> Publisher::connect(const std::string& address, int version) {
  const config::Endpoint& broker = candidate().broker;
  {
    const Guard lock(mutex_);
    if (finishing_) {
      return Refusal{};
    }
    // Paho may look up a name itself, and holds up whatever else is asked of it then.
    expect_sign_of_life(broker.tls ? settings_.resolve_patience : settings_.silence);
    line_.begin();
  }
  ClientSettings settings = settings_.client;
  std::string mistake = read_password(settings_.password_file, settings.password);
  if (mistake.empty() && broker.tls) {
    mistake = tls_files_mistake(settings.tls);
  }
  if (!mistake.empty()) {
    return Refusal{.why = std::move(mistake)};
  }
  settings.uri = (broker.tls ? "ssl://" : "tcp://") + uri_host(address) + ":" + std::to_string(broker.port);
  settings.version = version;
  gate_ = std::make_unique<EventGate>(static_cast<ClientEvents&>(*this));
  client_ = std::make_unique<Client>(settings, *gate_);
  if (!client_->connect()) {
    return Refusal{};
  }
  std::optional<Refusal> refusal = await_connection(connect_patience(), version);
  if (refusal && refusal->code < 0 && broker.tls) {
    if (std::string why = mistake_of_tls(); !why.empty()) {
      return Refusal{.why = std::move(why)};
    }
  }
  return refusal;
}

std::chrono::milliseconds Publisher::connect_patience() {
  const bool returns = rotation_.at() == 0 && homecoming_.is_arriving();  // which was tried before
  if (!has_elsewhere() || !rotation_.is_first_round() || returns) {
    return settings_.client.connect_timeout + kPahoDelay;
  }
  const auto share = kTurnPatience / static_cast<std::chrono::milliseconds::rep>(candidate().attempts.addresses());
  return std::min<std::chrono::milliseconds>(std::max<std::chrono::milliseconds>(share, kShortestPatience),
                                             settings_.hurried);
}

std::optional<Refusal> Publisher::await_connection(std::chrono::milliseconds patience, int version) {
  Lock lock(mutex_);
  wake_.wait_for(lock, patience, [this] { return line_.state != Line::State::connecting || finishing_; });
  if (!line_.stood()) {
    return line_.refusal;
  }
  traffic_.begin(line_.limits, version, Clock::now());
  pulse_.heard(Clock::now());
  return std::nullopt;
}

std::string Publisher::mistake_of_tls() {
  if (is_finishing()) {
    return {};
  }
  return tls_mistake(candidate().broker, candidate().resolved, settings_.client.tls,
                     is_one_of_several() ? kTlsPatienceOfSeveral : kTlsPatience);
}

bool Publisher::is_finishing() const {
  const Guard lock(mutex_);
  return finishing_;
}

}  // namespace mqtt
