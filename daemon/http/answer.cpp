#include "daemon/http/answer.h"

#include "bridges/text/json_text.h"

namespace gateway::http {

Answer refusal(unsigned status, std::string_view why) {
  Answer answer{.status = status};
  text::ObjectText object(answer.body);
  object.text("error", why);
  object.close();
  return answer;
}

Answer too_much(std::string_view why) {
  Answer answer = refusal(503, why);
  answer.come_again = true;
  return answer;
}

Answer refusal(unsigned status, std::string_view why, std::string_view key, std::span<const std::string> known) {
  Answer answer{.status = status};
  text::ObjectText object(answer.body);
  object.text("error", why);
  text::append_list(object.key(key), known, text::append_quoted);
  object.close();
  return answer;
}

}  // namespace gateway::http
