// Lists what programs consist of, as SPDX 2.3 in JSON, on standard output: the Debian packages of the libraries that they are
// linked with, those of headers that are compiled into them, and the npm packages that the viewer bundles.
// usage: node sbom.mjs VERSION ARCHITECTURE PACKAGE_LOCK PROGRAM...
import { execFileSync, spawnSync } from 'node:child_process';
import { readFileSync, realpathSync } from 'node:fs';
import { debianPackage, document, npmPackages } from './spdx.mjs';

// Libraries that are nothing but headers, so that no program names them.
const HEADERS = ['libboost1.81-dev', 'libeigen3-dev', 'libcli11-dev', 'libnanoflann-dev', 'libtomlplusplus-dev'];

const run = (command, ...args) =>
  execFileSync(command, args, { encoding: 'utf8', maxBuffer: 1 << 26, stdio: ['ignore', 'pipe', 'ignore'] });

/** Files of the libraries that a program loads, and of those that these load. */
export function librariesOf(program) {
  return [...run('ldd', program).matchAll(/(?:=> )?(\/\S+) \(0x/g)].map((match) => match[1]);
}

/** The Debian packages that files came with. Packages know them by the names before /lib became /usr/lib, or after. */
export function ownersOf(files) {
  const names = new Map(
    files.map((file) => {
      const real = realpathSync(file);
      return [file, [file, real, real.replace(/^\/usr/, ''), `/usr${file}`]];
    }),
  );
  const told = spawnSync('dpkg-query', ['--search', ...[...names.values()].flat()], {
    encoding: 'utf8',
    maxBuffer: 1 << 26,
  });
  const owners = new Map(
    told.stdout
      .split('\n')
      .map((line) => line.match(/^([^:,]+)[^/]*: (.+)$/) ?? [])
      .map(([, owner, name]) => [name, owner]),
  );
  return new Set(
    [...names].map(([file, candidates]) => {
      const known = candidates.find((name) => owners.has(name));
      if (!known) throw new Error(`${file} came with no Debian package; what it is made of cannot be told`);
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
  const told = Object.fromEntries(fields.map((field, i) => [field, values[i]]));
  let copyright = '';
  try {
    copyright = readFileSync(`/usr/share/doc/${told.Package}/copyright`, 'utf8');
  } catch {
    // minimal systems have no documentation: the licence is not asserted
  }
  return debianPackage(told, copyright);
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
