#include "daemon/control/request.h"

#include <gmock/gmock.h>

#include <string>

namespace gateway::control {
namespace {

using canopen::ErrorKind;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using text::Scalar;

TEST(ControlRequest, Set) {
  const Line line = parse_line(
      R"({"id":1,"op":"set","drive":"pump1","values":{"frequency_command":30.0,"control_command":"run","up":true}})");
  ASSERT_TRUE(line.request.has_value()) << to_string(line.request.error());
  EXPECT_EQ(line.id, "1");
  const Request& request = line.request.value();
  EXPECT_EQ(request.op, Op::set);
  EXPECT_EQ(request.drive, "pump1");
  EXPECT_THAT(request.values, ElementsAre(Pair("frequency_command", Scalar{Scalar::Kind::number, "30.0"}),
                                          Pair("control_command", Scalar{Scalar::Kind::string, "run"}),
                                          Pair("up", Scalar{Scalar::Kind::boolean, "true"})));
}

TEST(ControlRequest, OfEveryOtherKind) {
  const Line nmt = parse_line(R"({"op":"nmt","id":"a\"1","drive":"pump1","command":"reset-node"})");
  ASSERT_TRUE(nmt.request.has_value());
  EXPECT_EQ(nmt.id, R"("a\"1")");
  EXPECT_EQ(nmt.request.value().op, Op::nmt);
  EXPECT_EQ(nmt.request.value().command, "reset-node");

  const Line read = parse_line(R"({"op":"sdo-read","drive":"pump1","object":"0x2002:03"})");
  ASSERT_TRUE(read.request.has_value());
  EXPECT_EQ(read.id, "null");
  EXPECT_EQ(read.request.value().op, Op::sdo_read);
  EXPECT_EQ(read.request.value().object, "0x2002:03");
  EXPECT_EQ(read.request.value().type, std::nullopt);

  const Line write = parse_line(
      R"({"op":"sdo-write","drive":"pump1","object":"0x2002:03","type":"u64","value":18446744073709551615})");
  ASSERT_TRUE(write.request.has_value());
  EXPECT_EQ(write.request.value().op, Op::sdo_write);
  EXPECT_EQ(write.request.value().type, "u64");
  EXPECT_EQ(write.request.value().value, (Scalar{Scalar::Kind::number, "18446744073709551615"}));

  EXPECT_EQ(parse_line(R"({"id":0.5,"op":"status"})").request.value().op, Op::status);
  EXPECT_EQ(parse_line(" {\"op\":\"stop\"}\r").request.value().op, Op::stop);
}

TEST(ControlRequest, Streams) {
  const Line trace =
      parse_line(R"({"id":1,"op":"trace","names":"pump1,can0","kinds":"sdo","cob_ids":"585","raw":true})");
  ASSERT_TRUE(trace.request.has_value()) << to_string(trace.request.error());
  const Request& request = trace.request.value();
  EXPECT_EQ(request.op, Op::trace);
  EXPECT_EQ(request.names, "pump1,can0");
  EXPECT_EQ(request.kinds, "sdo");
  EXPECT_EQ(request.cob_ids, "585");
  EXPECT_TRUE(request.raw);
  EXPECT_TRUE(is_stream(request));
  EXPECT_TRUE(is_stream(parse_line(R"({"op":"trace"})").request.value()));
  EXPECT_TRUE(is_stream(parse_line(R"({"op":"status","watch":true})").request.value()));
  EXPECT_FALSE(is_stream(parse_line(R"({"op":"status","watch":false})").request.value()));
  EXPECT_FALSE(is_stream(parse_line(R"({"op":"stop"})").request.value()));
}

struct Refused {
  std::string text;
  ErrorKind kind;
  std::string id;
  std::string why;
};

TEST(ControlRequest, IsRefusedWithAClearWord) {
  const std::vector<Refused> all{
      {"garbage", ErrorKind::type, "null", "not valid JSON at character 1"},
      {"", ErrorKind::type, "null", "not valid JSON"},
      {"[]", ErrorKind::type, "null", "a list"},
      {"17", ErrorKind::type, "null", "a single value"},
      {R"({"op":"status"} {"op":"status"})", ErrorKind::type, "null", "more behind the object"},
      {R"({"id":1,"op":"set","drive":"pump1","values":{"a":1}})"
       "x",
       ErrorKind::type, "null", "more behind"},
      {R"({"id":1})", ErrorKind::type, "1", "\"op\" is missing"},
      {R"({"id":1,"op":5})", ErrorKind::type, "1", "\"op\" is to be a string"},
      {R"({"id":1,"op":"start"})", ErrorKind::unknown, "1", "there are set, nmt, sdo-read, sdo-write, status, stop"},
      {R"({"id":null,"op":"status"})", ErrorKind::type, "null", "\"id\" is to be a string or a number"},
      {R"({"id":true,"op":"stop"})", ErrorKind::type, "null", "\"id\" is to be"},
      {R"({"id":1,"id":2,"op":"status"})", ErrorKind::type, "null", "\"id\" twice"},
      {R"({"id":1,"op":"stop","drive":"pump1"})", ErrorKind::type, "1", "unknown member \"drive\"; of \"stop\""},
      {R"({"id":1,"op":"stop","values":{}})", ErrorKind::type, "1", "unknown member \"values\""},
      {R"({"id":1,"op":"set","values":{"a":1}})", ErrorKind::type, "1", "\"drive\" is missing"},
      {R"({"id":1,"op":"set","drive":5,"values":{"a":1}})", ErrorKind::type, "1", "\"drive\" is to be a string"},
      {R"({"id":1,"op":"set","drive":"pump1"})", ErrorKind::type, "1", "\"values\" is to be an object"},
      {R"({"id":1,"op":"set","drive":"pump1","values":3})", ErrorKind::type, "1", "\"values\" is to be an object"},
      {R"({"id":1,"op":"set","drive":"pump1","values":{"a":1},"values":{"b":1}})", ErrorKind::type, "null",
       "\"values\" twice"},
      {R"({"id":1,"op":"set","drive":"pump1","values":3,"values":{"b":1}})", ErrorKind::type, "null",
       "\"values\" twice"},
      {R"({"id":1,"op":"set","drive":"pump1","values":{"a":1,"a":2}})", ErrorKind::type, "null", "\"a\" twice"},
      {R"({"id":1,"op":"set","drive":"pump1","values":{"a":{"b":1}}})", ErrorKind::type, "null", "an object inside"},
      {R"({"id":1,"op":"set","drive":{"a":1}})", ErrorKind::type, "null", "an object inside"},
      {R"({"id":1,"op":"set","drive":"pump1","values":{"a":1},"dryrun":true})", ErrorKind::type, "1",
       "unknown member \"dryrun\"; of \"set\" there are id, op, drive, values"},
      {R"({"id":1,"op":"nmt","drive":"pump1"})", ErrorKind::type, "1", "\"command\" is missing"},
      {R"({"id":1,"op":"sdo-read","drive":"pump1"})", ErrorKind::type, "1", "\"object\" is missing"},
      {R"({"id":1,"op":"sdo-read","drive":"p","object":"0x1:1","type":7})", ErrorKind::type, "1", "\"type\" is to be"},
      {R"({"id":1,"op":"sdo-read","drive":"p","object":"0x1:1","value":7})", ErrorKind::type, "1", "\"value\"; of"},
      {R"({"id":1,"op":"sdo-write","drive":"p","object":"0x1:1"})", ErrorKind::type, "1", "\"value\" is missing"},
  };
  for (const Refused& expected : all) {
    const Line line = parse_line(expected.text);
    ASSERT_TRUE(line.request.has_error()) << expected.text;
    EXPECT_EQ(line.request.error().kind, expected.kind) << expected.text;
    EXPECT_THAT(line.request.error().detail, HasSubstr(expected.why)) << expected.text;
    EXPECT_EQ(line.id, expected.id) << expected.text;
  }
}

}  // namespace
}  // namespace gateway::control
