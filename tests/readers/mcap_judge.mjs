// Writes and lists MCAP files with the format's own library.
// usage: mcap_judge.mjs write FILE COMPRESSION    writes messages; COMPRESSION is none or zstd
//        mcap_judge.mjs list FILE                 prints the messages: topic, type, time in ns, bytes in hex
import { readFileSync, writeFileSync } from 'node:fs';

const kAbsent = 77; // the library is not installed

async function library() {
  try {
    const { McapStreamReader, McapWriter } = await import('@mcap/core');
    const { loadDecompressHandlers } = await import('@mcap/support');
    const zstd = await import('@foxglove/wasm-zstd');
    await zstd.isLoaded;
    return { McapStreamReader, McapWriter, loadDecompressHandlers, zstd };
  } catch (missing) {
    console.error(missing.message);
    process.exit(kAbsent);
  }
}

class MemoryWritable {
  pieces = [];
  size = 0n;

  async write(bytes) {
    this.pieces.push(Buffer.from(bytes));
    this.size += BigInt(bytes.byteLength);
  }

  position() {
    return this.size;
  }
}

async function write(file, compression) {
  const { McapWriter, zstd } = await library();
  const compressors = {
    none: undefined,
    zstd: (bytes) => ({ compression: 'zstd', compressedData: new Uint8Array(zstd.compress(bytes, 3)) }),
  };
  const writable = new MemoryWritable();
  const writer = new McapWriter({ writable, chunkSize: 2000, compressChunk: compressors[compression] });
  await writer.start({ profile: 'ros2', library: 'judge' });
  const schemaId = await writer.registerSchema({
    name: 'sensor_msgs/msg/LaserScan',
    encoding: 'ros2msg',
    data: new TextEncoder().encode('float32 x\n'),
  });
  const channels = [];
  for (const topic of ['/scan', '/rear/scan']) {
    channels.push(await writer.registerChannel({ schemaId, topic, messageEncoding: 'cdr', metadata: new Map() }));
  }
  for (let i = 0; i < 300; ++i) {
    const time = 1_700_000_000_000_000_000n + BigInt(i) * 1_000_000_001n;
    await writer.addMessage({
      channelId: channels[i % 2],
      sequence: i,
      logTime: time,
      publishTime: time + 5n,
      data: Uint8Array.from({ length: i % 90 }, (_, k) => (i * k) % 256),
    });
  }
  await writer.addAttachment({
    name: 'notes',
    mediaType: 'text/plain',
    logTime: 1n,
    createTime: 1n,
    data: new Uint8Array(300),
  });
  await writer.end();
  writeFileSync(file, Buffer.concat(writable.pieces));
}

async function list(file) {
  const { McapStreamReader, loadDecompressHandlers } = await library();
  const reader = new McapStreamReader({ decompressHandlers: await loadDecompressHandlers(), validateCrcs: true });
  reader.append(readFileSync(file));
  const schemas = new Map();
  const channels = new Map();
  const lines = [];
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
    if (record.type === 'Schema') schemas.set(record.id, record.name);
    if (record.type === 'Channel') channels.set(record.id, record);
    if (record.type !== 'Message') continue;
    const { topic, schemaId } = channels.get(record.channelId);
    lines.push(
      `${topic} ${schemas.get(schemaId)} ${record.logTime} ${Buffer.from(record.data).toString('hex') || '-'}`,
    );
  }
  if (!reader.done()) throw new Error(`${file} has no end`);
  console.log(lines.join('\n'));
}

const [action, file, compression] = process.argv.slice(2);
await (action === 'write' ? write(file, compression) : list(file));
