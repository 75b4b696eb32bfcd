#!/usr/bin/python3
"""with_pymodbus.py PORT UNIT NOBODY: every function that pymodbus has, at the drive of modbus.sh; a line for each result.

with_modbus_serial.js prints the same lines. NOBODY is a unit that nobody has."""
import sys

from pymodbus.client import ModbusTcpClient
from pymodbus.mei_message import ReadDeviceInformationRequest

port, unit, nobody = map(int, sys.argv[1:])
client = ModbusTcpClient("127.0.0.1", port=port)
if not client.connect():
    sys.exit("no connection")


def good(answer):
    if answer.isError():
        sys.exit(str(answer))
    return answer


def tell(what, *values):
    print(what, *(int(value) for value in values))


good(client.write_coil(400, True, slave=unit))
tell("coil on", *good(client.read_coils(400, 1, slave=unit)).bits[:1])
good(client.write_coils(400, [False], slave=unit))
tell("input off", *good(client.read_discrete_inputs(400, 1, slave=unit)).bits[:1])
good(client.write_register(103, 500, slave=unit))
tell("single", *good(client.read_holding_registers(103, 1, slave=unit)).registers)
good(client.write_registers(300, [0, 700], slave=unit))
tell("wide", *good(client.read_input_registers(300, 2, slave=unit)).registers)
good(client.mask_write_register(103, 0xFF00, 0x0007, unit=unit))
tell("masked", *good(client.read_holding_registers(103, 1, slave=unit)).registers)
good(client.readwrite_registers(read_address=103, read_count=1, write_address=103, write_registers=[0], unit=unit))
tell("read and written", *good(client.read_holding_registers(103, 1, slave=unit)).registers)
tell("as many as go", len(good(client.read_holding_registers(0, 125, slave=unit)).registers))
tell("not writable", client.write_register(0, 1, slave=unit).exception_code)
tell("no such address", client.read_holding_registers(999, 1, slave=unit).exception_code)
tell("half", client.write_register(300, 1, slave=unit).exception_code)
tell("refused", client.write_registers(300, [0, 0], slave=unit).exception_code)
tell("nobody", client.read_holding_registers(0, 1, slave=nobody).exception_code)
told = good(client.execute(ReadDeviceInformationRequest(read_code=3, object_id=0, unit=unit))).information
print("identified", *(told[number].decode() for number in (0, 1, 4, 6, 0x80, 0x81)), sep="; ")
