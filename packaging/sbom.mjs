// Lists the components of programs as SPDX 2.3 in JSON, on standard output: the Debian packages of the linked
// libraries, those of headers that are compiled in, and the npm packages that the viewer bundles.
// usage: node sbom.mjs VERSION ARCHITECTURE PACKAGE_LOCK PROGRAM...
import { execFileSync, spawnSync } from 'node:child_process';
import { readFileSync, realpathSync } from 'node:fs';
import { debianPackage, document, npmPackages } from './spdx.mjs';

// Header-only libraries, which no program names.
const HEADERS = ['libboost1.81-dev', 'libeigen3-dev', 'libcli11-dev', 'libnanoflann-dev', 'libtomlplusplus-dev'];

const run = (command, ...args) =>
  execFileSync(command, args, { encoding: 'utf8', maxBuffer: 1 << 26, stdio: ['ignore', 'pipe', 'ignore'] });

/** Returns the files of the libraries that a program loads, directly or indirectly. */
export function librariesOf(program) {
  return [...run('ldd', program).matchAll(/(?:=> )?(\/\S+) \(0x/g)].map((match) => match[1]);
}

/** Returns the Debian packages of files. Packages list them by their names before or after /lib became /usr/lib. */
export function ownersOf(files) {
  const names = new Map(
    files.map((file) => {
      const real = realpathSync(file);
      return [file, [file, real, real.replace(/^\/usr/, ''), `/usr${file}`]];
    }),
  );
  const search = spawnSync('dpkg-query', ['--search', ...[...names.values()].flat()], {
    encoding: 'utf8',
    maxBuffer: 1 << 26,
  });
  const owners = new Map(
    search.stdout
      .split('\n')
      .map((line) => line.match(/^([^:,]+)[^/]*: (.+)$/) ?? [])
      .map(([, owner, name]) => [name, owner]),
  );
  return new Set(
    [...names].map(([file, candidates]) => {
      const known = candidates.find((name) => owners.has(name));
      if (!known) throw new Error(`${file} is in no Debian package; its components are unknown`);
      return owners.get(known);
    }),
  );
}

function installed(name) {
  const fields = ['Package', 'Version', 'Architecture', 'source:Package', 'source:Version', 'Homepage', 'Maintainer'];
  const values = run(
    'dpkg-query',
    '--show',
    `--showformat=${fields.map((field) => `\${${field}}\\n`).join('')}`,
    name,
  ).split('\n');
  const packageFields = Object.fromEntries(fields.map((field, i) => [field, values[i]]));
  let copyright = '';
  try {
    copyright = readFileSync(`/usr/share/doc/${packageFields.Package}/copyright`, 'utf8');
  } catch {
    // minimal systems have no documentation: no licence is asserted
  }
  return debianPackage(packageFields, copyright);
}

if (process.argv[1] === realpathSync(new URL(import.meta.url).pathname)) {
  const [version, architecture, lock, ...programs] = process.argv.slice(2);
  const linked = ownersOf([...new Set(programs.flatMap(librariesOf))]);
  const made = document({
    version,
    architecture,
    created: new Date(Number(process.env.SOURCE_DATE_EPOCH ?? Date.now() / 1000) * 1000),
    linked: [...linked].sort().map(installed),
    compiledIn: HEADERS.map(installed),
    bundled: npmPackages(JSON.parse(readFileSync(lock, 'utf8'))),
  });
  process.stdout.write(`${JSON.stringify(made, null, 2)}\n`);
}
