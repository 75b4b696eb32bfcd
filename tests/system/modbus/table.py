"""The conformance run and its Markdown table."""
from modbus import frames, requests
from modbus.expected import WRITES, Masked, expected, remember_write
from modbus.judge import Row, ask
from modbus.protocol import Connection

GIVE_UP = 20  # requests in a row; a server that is gone need not be asked ten thousand times
PREFACE = """Where the header does not matter, a request is the unit and the PDU, an answer the PDU;
their headers are right: the transaction id comes back, the protocol id is 0, the length agrees.
Bytes that move are dots."""
SECTION_HEAD = "| | request | answer | why |\n|---|---|---|---|"


def shorten(data):
    return data.hex(" ") if len(data) <= 20 else f"{data[:16].hex(' ')} … ({len(data)} bytes)"


def shown(answer, row):
    """The answer; bytes that move from run to run as dots, so that the table can stand in a document."""
    for _, rule in row.allowed:
        if isinstance(rule, Masked) and len(rule.value) == len(answer):
            text = rule.show(answer)
            return text if len(answer) <= 20 else f"{text[:47]} … ({len(answer)} bytes)"
    return shorten(answer)


class Table:
    """Collects the rows; prints the first of each group, every open one once, and each disagreement."""

    def __init__(self, everything):
        self.everything = everything
        print(PREFACE)
        self.section, self.groups = None, {}
        self.total = self.failed = self.open = 0

    def add(self, section, group, request, answer, text, good):
        self.total, self.failed = self.total + 1, self.failed + (not good)
        self.open += text.startswith("either")
        key = (section, group, text if good else None)
        shown_before = self.groups.get(key, 0)
        self.groups[key] = shown_before + 1
        if shown_before and good and not self.everything:
            return
        if section != self.section:
            print(f"\n### {section[0].upper()}{section[1:]}\n\n{SECTION_HEAD}")
            self.section = section
        mark = "ok" if good else "**no**"
        print(f"| {mark} | `{request}` | `{answer or 'nothing'}` | {group}: {text} |")

    def summary(self):
        print(f"\n{self.total} requests, {self.failed} disagreements, {self.open} where the papers leave it open.\n")
        if not self.everything:
            print("Rows of one group that were answered alike stand here once; how many there were:\n")
            print("| section | group | answered | requests |\n|---|---|---|---|")
            for (section, group, text), count in self.groups.items():
                print(f"| {section} | {group} | {text or '**no**'} | {count} |")


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


def run_frames(peer, units, options, table):
    """Segments, each on its own connection; a neighbour that was there before is served all the while."""
    unit = next(iter(units))
    stranger = next(number for number in range(254, 0, -1) if number not in units)
    neighbour = Connection(*peer, options.patience)
    question = Row(frames.QUESTION, [("the neighbour is served", frames.REFUSAL)])
    for segments in frames.all_segments(unit, stranger):
        answer, end, text, good = frames.run_segments(peer, segments, options.quiet, options.patience)
        sent = b"".join(part for part in segments.parts if isinstance(part, bytes))
        told = f"{shorten(answer)}, {end}" if answer else end
        table.add(segments.section, segments.group, shorten(sent), told, text, good)
        _, text, good = ask(neighbour, unit, question)
        if not good:
            table.add(segments.section, "neighbour", question.request.hex(" "), "", text, False)
    for half, answer, end, text, good in frames.half_request_rows(peer, unit, options.half_request_deadline):
        table.add("half requests", "nobody completes them", half.hex(" "), f"{answer.hex(' ')}{end}", text, good)
    answer, text, good = ask(neighbour, unit, question)
    table.add("half requests", "meanwhile", question.request.hex(" "), answer.hex(" "), text, good)
    neighbour.close()
