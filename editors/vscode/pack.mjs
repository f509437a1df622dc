// Makes the .vsix: a zip with the extension, its manifest and the types of its files. Nothing is fetched.
//
// node pack.mjs [FILE]

import { readFileSync, readdirSync, statSync, writeFileSync } from 'node:fs';
import { join, relative, sep } from 'node:path';
import { fileURLToPath } from 'node:url';
import { crc32, deflateRawSync } from 'node:zlib';
import { notices } from './notices.mjs';

const here = fileURLToPath(new URL('.', import.meta.url));
const about = JSON.parse(readFileSync(join(here, 'package.json'), 'utf8'));

/** The files and folders of the extension. */
const PARTS = ['package.json', 'README.md', 'language-configuration.json', 'out', 'syntaxes'];

const TYPES = { json: 'application/json', md: 'text/markdown', js: 'application/javascript', txt: 'text/plain', vsixmanifest: 'text/xml' };

function walk(path) {
  if (!statSync(path).isDirectory()) return [path];
  return readdirSync(path).sort().flatMap((name) => walk(join(path, name)));
}

function escaped(text) {
  return text.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
}

function manifest() {
  return `<?xml version="1.0" encoding="utf-8"?>
<PackageManifest Version="2.0.0" xmlns="http://schemas.microsoft.com/developer/vsx-schema/2011">
  <Metadata>
    <Identity Language="en-US" Id="${escaped(about.name)}" Version="${about.version}" Publisher="${escaped(about.publisher)}"/>
    <DisplayName>${escaped(about.displayName)}</DisplayName>
    <Description xml:space="preserve">${escaped(about.description)}</Description>
    <Tags>${escaped(about.keywords.join(','))}</Tags>
    <Categories>${escaped(about.categories.join(','))}</Categories>
    <Properties>
      <Property Id="Microsoft.VisualStudio.Code.Engine" Value="${escaped(about.engines.vscode)}"/>
      <Property Id="Microsoft.VisualStudio.Code.ExtensionKind" Value="workspace"/>
    </Properties>
    <License>extension/LICENSE.txt</License>
  </Metadata>
  <Installation><InstallationTarget Id="Microsoft.VisualStudio.Code"/></Installation>
  <Dependencies/>
  <Assets>
    <Asset Type="Microsoft.VisualStudio.Code.Manifest" Path="extension/package.json" Addressable="true"/>
    <Asset Type="Microsoft.VisualStudio.Services.Content.Details" Path="extension/README.md" Addressable="true"/>
    <Asset Type="Microsoft.VisualStudio.Services.Content.License" Path="extension/LICENSE.txt" Addressable="true"/>
  </Assets>
</PackageManifest>
`;
}

function types() {
  const rows = Object.entries(TYPES).map(([end, type]) => `<Default Extension=".${end}" ContentType="${type}"/>`);
  return `<?xml version="1.0" encoding="utf-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">${rows.join('')}</Types>
`;
}

/** What VS Code reads of `package.json`: nothing about the build. */
function shipped() {
  const { scripts, devDependencies, dependencies, private: hidden, ...rest } = about;
  return JSON.stringify(rest, null, 2) + '\n';
}

function entries() {
  const files = PARTS.flatMap((part) => walk(join(here, part)));
  const all = files.map((file) => {
    const name = relative(here, file).split(sep).join('/');
    return [`extension/${name}`, name === 'package.json' ? Buffer.from(shipped()) : readFileSync(file)];
  });
  const licences = ['LICENSE-MIT', 'LICENSE-APACHE'].map((name) => readFileSync(join(here, '../..', name), 'utf8'));
  all.push(['extension/LICENSE.txt', Buffer.from(licences.join('\n\n'))]);
  all.push(['extension/NOTICES.txt', Buffer.from(notices(here))]);
  return [['extension.vsixmanifest', Buffer.from(manifest())], ['[Content_Types].xml', Buffer.from(types())], ...all];
}

/** 1 January 1980, the first day of zip: the same bytes at each build. */
const DATE = (1 << 5) | 1;

function zip(list) {
  const parts = [];
  const directory = [];
  let at = 0;
  for (const [name, data] of list) {
    const packed = deflateRawSync(data, { level: 9 });
    const path = Buffer.from(name);
    const common = Buffer.alloc(26);
    common.writeUInt16LE(20, 0); // the version that is needed
    common.writeUInt16LE(0x800, 2); // names are UTF-8
    common.writeUInt16LE(8, 4); // deflate
    common.writeUInt16LE(DATE, 8);
    common.writeUInt32LE(crc32(data), 10);
    common.writeUInt32LE(packed.length, 14);
    common.writeUInt32LE(data.length, 18);
    common.writeUInt16LE(path.length, 22);
    parts.push(Buffer.from('PK\x03\x04', 'latin1'), common, path, packed);
    const row = Buffer.alloc(14);
    row.writeUInt32LE(at, 10);
    directory.push(Buffer.from('PK\x01\x02\x14\x00', 'latin1'), common, row, path);
    at += 4 + common.length + path.length + packed.length;
  }
  const index = Buffer.concat(directory);
  const end = Buffer.alloc(22);
  end.write('PK\x05\x06', 0, 'latin1');
  end.writeUInt16LE(list.length, 8);
  end.writeUInt16LE(list.length, 10);
  end.writeUInt32LE(index.length, 12);
  end.writeUInt32LE(at, 16);
  return Buffer.concat([...parts, index, end]);
}

const file = process.argv[2] ?? join(here, `g7-${about.version}.vsix`);
writeFileSync(file, zip(entries()));
console.log(file);
