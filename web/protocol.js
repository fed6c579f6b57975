/** The live messages' readers and writers, made from the .proto files that the server is built from. */
import { readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { compileRaw } from 'pbf/compile';
import schema from 'protocol-buffers-schema';

const kProtoDirectory = join(dirname(fileURLToPath(import.meta.url)), '../proto');
const kLive = 'scanloom/v1/live.proto';
const kModule = 'virtual:live-protocol';

/** A module's text: readLiveEvent(pbf), writeLiveRequest(message, pbf), ... */
export function liveProtocol() {
  return compileRaw(withImports(kLive), {});
}

/** For Vite: the module of that text. */
export function liveProtocolPlugin() {
  return {
    name: 'live-protocol',
    resolveId: (id) => (id === kModule ? `\0${kModule}` : null),
    load: (id) => (id === `\0${kModule}` ? liveProtocol() : null),
  };
}

/** A file and all that it imports, each named from the root as protoc has it. */
function withImports(file, seen = new Set()) {
  seen.add(file);
  const parsed = schema.parse(readFileSync(join(kProtoDirectory, file), 'utf8'));
  for (const imported of parsed.imports.filter((each) => !seen.has(each))) {
    const { messages, enums } = withImports(imported, seen);
    parsed.messages.push(...messages);
    parsed.enums.push(...enums);
  }
  return parsed;
}

// As a program it writes the module, for tools other than Vite.
if (process.argv[1] === fileURLToPath(import.meta.url)) process.stdout.write(liveProtocol());
