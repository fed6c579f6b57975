// Creates and checks SPDX 2.3 documents (https://spdx.github.io/spdx-spec/v2.3/). Accesses no file and no process.
import { createHash } from 'node:crypto';

// Short names in Debian's copyright files (DEP 5), and their SPDX identifiers.
const LICENCES = {
  'apache-2.0': 'Apache-2.0',
  'apache-2': 'Apache-2.0',
  'asl-2.0': 'Apache-2.0',
  artistic: 'Artistic-1.0-Perl',
  'bsd-2-clause': 'BSD-2-Clause',
  'bsd-3-clause': 'BSD-3-Clause',
  'bsd-3-clause-google': 'BSD-3-Clause',
  'bsl-1.0': 'BSL-1.0',
  'boost-1.0': 'BSL-1.0',
  'cc0-1.0': 'CC0-1.0',
  curl: 'curl',
  expat: 'MIT',
  mit: 'MIT',
  'mit/x11': 'MIT',
  isc: 'ISC',
  'gpl-1+': 'GPL-1.0-or-later',
  'gpl-2': 'GPL-2.0-only',
  'gpl-2+': 'GPL-2.0-or-later',
  'gpl-3': 'GPL-3.0-only',
  'gpl-3+': 'GPL-3.0-or-later',
  'lgpl-2': 'LGPL-2.0-only',
  'lgpl-2+': 'LGPL-2.0-or-later',
  'lgpl-2.0+': 'LGPL-2.0-or-later',
  'lgpl-2.1': 'LGPL-2.1-only',
  'lgpl-2.1+': 'LGPL-2.1-or-later',
  'lgpl-3': 'LGPL-3.0-only',
  'lgpl-3+': 'LGPL-3.0-or-later',
  libpng: 'Libpng',
  'mpl-2.0': 'MPL-2.0',
  'mpl-2': 'MPL-2.0',
  openssl: 'OpenSSL',
  zlib: 'Zlib',
};

const NONE = 'NOASSERTION';
const idOf = (...words) => `SPDXRef-${words.join('-').replace(/[^A-Za-z0-9.-]/g, '-')}`;

/** Returns the licence of a package's own files ("Files: *") as an SPDX expression; NOASSERTION if it is unclear. */
export function licenceOf(copyright) {
  const own = copyright.split(/\n\s*\n/).find((paragraph) => /^Files:\s*\*\s*$/m.test(paragraph));
  const words = own?.match(/^License:[ \t]*(\S.*)$/m)?.[1].trim();
  if (!words) return NONE;
  const parts = words.split(/,?\s+(and|or)\s+/i);
  const known = parts.map((part, i) => (i % 2 ? part.toUpperCase() : LICENCES[part.toLowerCase()]));
  if (known.includes(undefined)) return NONE;
  return new Set(known.filter((_, i) => i % 2)).size > 1 ? NONE : known.join(' '); // "a and b or c" may mean two things
}

/** @param fields  fields of dpkg-query */
export function debianPackage(fields, copyright) {
  const licence = licenceOf(copyright);
  return {
    SPDXID: idOf('deb', fields.Package),
    name: fields.Package,
    versionInfo: fields.Version,
    supplier: `Organization: ${fields.Maintainer}`,
    downloadLocation: NONE, // any mirror may serve it: the purl identifies it, sourceInfo its source
    sourceInfo: `built from the Debian source package ${fields['source:Package']} ${fields['source:Version']}`,
    filesAnalyzed: false,
    ...(/^https?:\/\/\S+$/.test(fields.Homepage) ? { homepage: fields.Homepage } : {}),
    licenseConcluded: NONE,
    licenseDeclared: licence,
    ...(licence === NONE ? { licenseComments: `/usr/share/doc/${fields.Package}/copyright has the licence` } : {}),
    copyrightText: NONE,
    externalRefs: [
      purl(
        `pkg:deb/debian/${encodeURIComponent(fields.Package)}@${encodeURIComponent(fields.Version)}?arch=${fields.Architecture}&distro=debian-12`,
      ),
    ],
  };
}

const purl = (locator) => ({ referenceCategory: 'PACKAGE-MANAGER', referenceType: 'purl', referenceLocator: locator });

/** npm's licences are SPDX expressions already, some in brackets. */
function expressionOf(licence) {
  const plain = licence.replace(/^\((.*)\)$/, '$1');
  return EXPRESSION.test(plain) ? plain : NONE;
}

/** Returns the packages in an npm lock file (version 3) that the page itself contains, without build tools. */
export function npmPackages(lock) {
  return Object.entries(lock.packages)
    .filter(([path, entry]) => path !== '' && !entry.dev && !entry.devOptional && !entry.optional && !entry.peer)
    .map(([path, entry]) => {
      const name = path.split('node_modules/').at(-1);
      return {
        SPDXID: idOf('npm', name, entry.version),
        name,
        versionInfo: entry.version,
        supplier: NONE,
        downloadLocation: NONE, // any registry may serve it: purl and checksum identify it
        filesAnalyzed: false,
        ...(entry.integrity?.startsWith('sha512-')
          ? {
              checksums: [
                { algorithm: 'SHA512', checksumValue: Buffer.from(entry.integrity.slice(7), 'base64').toString('hex') },
              ],
            }
          : {}),
        licenseConcluded: NONE,
        licenseDeclared: expressionOf(entry.license ?? ''),
        copyrightText: NONE,
        externalRefs: [purl(`pkg:npm/${name.replace('@', '%40')}@${entry.version}`)],
      };
    });
}

/** @param parts  { version, architecture, created: Date, linked, compiledIn, bundled } */
export function document({ version, architecture, created, linked, compiledIn, bundled }) {
  const own = {
    SPDXID: 'SPDXRef-scanloom',
    name: 'scanloom',
    versionInfo: version,
    supplier: 'Organization: The Scanloom authors',
    downloadLocation: NONE,
    filesAnalyzed: false,
    licenseConcluded: 'Apache-2.0',
    licenseDeclared: 'Apache-2.0',
    copyrightText: NONE,
    primaryPackagePurpose: 'APPLICATION',
    externalRefs: [purl(`pkg:generic/scanloom@${version}?arch=${architecture}`)],
  };
  const relate = (packages, relationshipType) =>
    packages.map((one) => ({ spdxElementId: own.SPDXID, relationshipType, relatedSpdxElement: one.SPDXID }));
  const packages = [own, ...linked, ...compiledIn, ...bundled];
  const digest = createHash('sha256').update(JSON.stringify(packages)).digest('hex').slice(0, 32);
  return {
    spdxVersion: 'SPDX-2.3',
    dataLicense: 'CC0-1.0',
    SPDXID: 'SPDXRef-DOCUMENT',
    name: `scanloom-${version}-${architecture}`,
    documentNamespace: `https://spdx.org/spdxdocs/scanloom-${version}-${architecture}-${digest}`,
    creationInfo: {
      created: `${created.toISOString().slice(0, 19)}Z`,
      creators: ['Tool: scanloom-package', 'Organization: The Scanloom authors'],
    },
    packages,
    relationships: [
      { spdxElementId: 'SPDXRef-DOCUMENT', relationshipType: 'DESCRIBES', relatedSpdxElement: own.SPDXID },
      ...relate(linked, 'DYNAMIC_LINK'),
      ...relate(compiledIn, 'STATIC_LINK'),
      ...relate(bundled, 'CONTAINS'),
    ],
  };
}

const ID = /^SPDXRef-[A-Za-z0-9.-]+$/;
const EXPRESSION = /^[A-Za-z0-9.+-]+( (AND|OR) [A-Za-z0-9.+-]+)*$/;
const LOCATION = /^(NOASSERTION|NONE|(https?|git|ssh):\/\/\S+)$/;

/** Returns a sentence for each field that SPDX 2.3 requires and the document lacks (clauses 6, 7 and 11). */
export function faultsOf(made) {
  const faults = [];
  const demand = (holds, sentence) => holds || faults.push(sentence);
  demand(made.spdxVersion === 'SPDX-2.3', 'spdxVersion is not SPDX-2.3');
  demand(made.dataLicense === 'CC0-1.0', 'dataLicense is not CC0-1.0');
  demand(made.SPDXID === 'SPDXRef-DOCUMENT', 'SPDXID is not SPDXRef-DOCUMENT');
  demand(typeof made.name === 'string' && made.name !== '', 'the document has no name');
  demand(/^[a-z]+:\/\/[^#\s]+$/.test(made.documentNamespace ?? ''), 'documentNamespace is not an address, or has a #');
  demand(
    /^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$/.test(made.creationInfo?.created ?? ''),
    'creationInfo.created is not a time',
  );
  const creators = made.creationInfo?.creators ?? [];
  demand(
    creators.length > 0 && creators.every((one) => /^(Tool|Organization|Person): \S/.test(one)),
    'creationInfo.creators is empty or invalid',
  );
  const ids = new Set([made.SPDXID]);
  for (const one of made.packages ?? []) {
    const who = `package ${one.name ?? one.SPDXID}`;
    demand(ID.test(one.SPDXID ?? ''), `${who}: SPDXID is invalid`);
    demand(!ids.has(one.SPDXID), `${who}: its SPDXID is not unique`);
    ids.add(one.SPDXID);
    demand(typeof one.name === 'string' && one.name !== '', `${who} has no name`);
    demand(typeof one.versionInfo === 'string' && one.versionInfo !== '', `${who} has no version`);
    demand(LOCATION.test(one.downloadLocation ?? ''), `${who}: downloadLocation is invalid`);
    demand(one.filesAnalyzed === false, `${who}: files that are analysed need a verification code`);
    for (const field of ['licenseConcluded', 'licenseDeclared'])
      demand(EXPRESSION.test(one[field] ?? ''), `${who}: ${field} is not an expression`);
    demand(
      !one.supplier || /^(NOASSERTION|(Organization|Person): \S.*)$/.test(one.supplier),
      `${who}: supplier is invalid`,
    );
    for (const sum of one.checksums ?? [])
      demand(sum.algorithm !== 'SHA512' || /^[0-9a-f]{128}$/.test(sum.checksumValue), `${who}: no SHA512`);
  }
  demand((made.packages ?? []).length > 0, 'there are no packages');
  const relationships = made.relationships ?? [];
  demand(
    relationships.some((one) => one.relationshipType === 'DESCRIBES' && one.spdxElementId === 'SPDXRef-DOCUMENT'),
    'the described package is missing',
  );
  for (const { spdxElementId, relatedSpdxElement } of relationships) {
    for (const id of [spdxElementId, relatedSpdxElement])
      demand(ids.has(id), `a relationship names ${id}, which does not exist`);
  }
  return faults;
}
