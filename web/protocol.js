/** Generates JavaScript readers and writers of the live messages from the .proto files of the server. */
import { readFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { compileRaw } from 'pbf/compile';
import schema from 'protocol-buffers-schema';

const kProtoDirectory = join(dirname(fileURLToPath(import.meta.url)), '../proto');
const kLive = 'scanloom/v1/live.proto';
const kModule = 'virtual:live-protocol';

/** Returns the text of the module: readLiveEvent(pbf), writeLiveRequest(message, pbf), ... */
export function liveProtocol() {
  return compileRaw(withImports(kLive), {});
}

/** A Vite plugin that provides this module. */
export function liveProtocolPlugin() {
  return {
    name: 'live-protocol',
    resolveId: (id) => (id === kModule ? `\0${kModule}` : null),
    load: (id) => (id === `\0${kModule}` ? liveProtocol() : null),
  };
}

/** Reads a file and its imports; names are relative to the root, as for protoc. */
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

// Run as a program, it prints the module, for tools other than Vite.
if (process.argv[1] === fileURLToPath(import.meta.url)) process.stdout.write(liveProtocol());
