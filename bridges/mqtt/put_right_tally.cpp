#include "bridges/mqtt/put_right_tally.h"

#include <string>

namespace mqtt {

void PutRightTally::note(const std::vector<Message>& batch, canopen::TimePoint now, const Notice& notice) {
  for (const Message& message : batch) {
    if (!message.puts_right) {
      continue;
    }
    ++count_;
    if (!said_ || now - *said_ >= kPause) {
      said_ = now;
      notice(Level::warning, "MQTT: somebody else wrote on " + message.topic + "; it is put right (" +
                                 std::to_string(count_) + " times since the start, all topics together)");
    }
  }
}

}  // namespace mqtt
