// with_modbus_serial.js PORT UNIT NOBODY: every function that modbus-serial has, at the drive of modbus.sh; a line for
// each result. with_pymodbus.py prints the same lines. NOBODY is a unit that nobody has.
const ModbusRTU = require('modbus-serial');
const [port, unit, nobody] = process.argv.slice(2).map(Number);

const client = new ModbusRTU();
const tell = (what, ...values) => console.log(what, ...values.map(Number));
const code = (request) => request.then(() => 0, (error) => error.modbusCode);

async function run() {
  await client.connectTCP('127.0.0.1', { port });
  client.setTimeout(5000);
  client.setID(unit);
  await client.writeCoil(400, true);
  tell('coil on', (await client.readCoils(400, 1)).data[0]);
  await client.writeCoils(400, [false]);
  tell('input off', (await client.readDiscreteInputs(400, 1)).data[0]);
  await client.writeRegister(103, 500);
  tell('single', ...(await client.readHoldingRegisters(103, 1)).data);
  await client.writeRegisters(300, [0, 700]);
  tell('wide', ...(await client.readInputRegisters(300, 2)).data);
  await client.maskWriteRegister(103, 0xff00, 0x0007);
  tell('masked', ...(await client.readHoldingRegisters(103, 1)).data);
  await client.writeRegister(103, 0);  // it has no function 23
  tell('read and written', ...(await client.readHoldingRegisters(103, 1)).data);
  tell('as many as go', (await client.readHoldingRegisters(0, 125)).data.length);
  tell('not writable', await code(client.writeRegister(0, 1)));
  tell('no such address', await code(client.readHoldingRegisters(999, 1)));
  tell('half', await code(client.writeRegister(300, 1)));
  tell('refused', await code(client.writeRegisters(300, [0, 0])));
  client.setID(nobody);
  tell('nobody', await code(client.readHoldingRegisters(0, 1)));
  client.setID(unit);
  const told = (await client.readDeviceIdentification(3, 0)).data;
  console.log(['identified', ...[0, 1, 4, 6, 0x80, 0x81].map((number) => told[number])].join('; '));
  client.close(() => {});
}

run().catch((error) => {
  console.error(error);
  process.exit(1);
});
