"""The conformance run and its Markdown table: `*` marks answers for which the papers leave a choice."""
from modbus import frames, judge, requests
from modbus.expected import WRITES, Masked, expected, remember_write
from modbus.judge import Row, ask
from modbus.protocol import Connection

GIVE_UP = 20  # requests in a row; a server that is gone need not be asked ten thousand times
HEAD = """| function | request | for example | answer | requests |
|---|---|---|---|---|"""


def shorten(data):
    return data.hex(" ") if len(data) <= 12 else f"{data[:10].hex(' ')} … ({len(data)} bytes)"


def shown(answer, row):
    """The answer; bytes that move from run to run as dots, so that the table can stand in a document."""
    for _, rule in row.allowed:
        if isinstance(rule, Masked) and len(rule.value) == len(answer):
            text = rule.show(answer)
            return text if len(answer) <= 12 else f"{text[:29]} … ({len(answer)} bytes)"
    return shorten(answer)


class Table:
    """Collects the rows; prints each disagreement, or everything."""

    def __init__(self, everything):
        self.everything = everything
        self.groups = {}  # (section, group, what was answered): [example, requests]
        self.total = self.failed = self.open = 0

    def add(self, section, group, request, answer, text, good):
        self.total, self.failed = self.total + 1, self.failed + (not good)
        self.open += text.startswith("either")
        told = text.replace("either, here: ", "* ") if good else "**wrong**"
        example = f"`{request}` | `{answer or 'nothing'}`, {told}"
        self.groups.setdefault((section, group, told), [example, 0])[1] += 1
        if self.everything or not good:
            print(f"{'ok  ' if good else 'FAIL'} {section}, {group}: {request} -> {answer or 'nothing'}: {text}")

    def summary(self):
        print(f"{self.total} requests, {self.failed} disagreements, {self.open} where the papers leave it open")

    def markdown(self):
        """A row for each group and answer; what belongs to one section stands together."""
        def place(section):  # by function; what is no function stays behind, in its order
            number = section.replace(",", " ").replace("/", " ").split()[0]
            return int(number) if number.isdecimal() else 256
        sections = sorted(dict.fromkeys(section for section, _, _ in self.groups), key=place)
        rows = [f"| {section} | {group} | {example} | {count} |"
                for wanted in sections
                for (section, group, _), (example, count) in self.groups.items() if section == wanted]
        return "\n".join([HEAD, *rows]) + "\n"


def run_requests(peer, units, table, patience):
    """Unit and PDU of each request on one connection; the header is checked with each answer."""
    connection = Connection(*peer, patience)
    silent = 0
    for section, group, number, pdu in requests.all_requests(units):
        row = Row(pdu, expected(units, number, pdu))
        answer, text, good = ask(connection, number, row)
        silent = silent + 1 if "timed out" in text else 0
        if silent == GIVE_UP:
            table.add(section, group, "the rest", "", f"given up after {GIVE_UP} requests without an answer", False)
            break
        if good and pdu[0] in WRITES and answer[0] == pdu[0]:
            remember_write(units[number], pdu)
        table.add(section, group, shorten(bytes([number]) + pdu), shown(answer, row), text, good)
    connection.close()


def run_objects(peer, units, table, patience):
    """Function 43 of each unit of whose objects something is known."""
    for number, unit in units.items():
        if not unit.objects:
            continue
        connection = Connection(*peer, patience)
        for section, group, row in judge.all_rows(connection, judge.options_of(number, unit.objects)):
            answer, text, good = ask(connection, number, row)
            table.add(section, group, shorten(bytes([number]) + row.request), shorten(answer), text, good)
        connection.close()


def run_frames(peer, units, options, table):
    """Segments, each on its own connection; a neighbour that was there before is served all the while."""
    unit = next(iter(units))
    stranger = next(number for number in range(254, 0, -1) if number not in units)
    neighbour = Connection(*peer, options.patience)
    halves = frames.HalfRequests(peer, unit, options.half_request_deadline)
    question = Row(frames.QUESTION, [("the neighbour is served", frames.REFUSAL)])
    for segments in frames.all_segments(unit, stranger):
        answer, end, text, good = frames.run_segments(peer, segments, options.quiet, options.patience)
        sent = b"".join(part for part in segments.parts if isinstance(part, bytes))
        told = f"{shorten(answer)}, {end}" if answer else end
        table.add(segments.section, segments.group, shorten(sent), told, text, good)
        _, text, good = ask(neighbour, unit, question)
        if not good:
            table.add(segments.section, "neighbour", question.request.hex(" "), "", text, False)
    for half, answer, end, text, good in halves.rows():
        table.add("half requests", "nobody completes them", half.hex(" "), f"{answer.hex(' ')}{end}", text, good)
    answer, text, good = ask(neighbour, unit, question)
    table.add("half requests", "meanwhile", question.request.hex(" "), answer.hex(" "), text, good)
    neighbour.close()
