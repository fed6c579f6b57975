// A linter and a parser read the description of the HTTP API that the server returns.
import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import SwaggerParser from '@apidevtools/swagger-parser';
import { createConfig, lint } from '@redocly/openapi-core';
import { endWithThisProgram, Server } from '../e2e/programs.mjs';

const folder = mkdtempSync(join(tmpdir(), 'scanloom-openapi-'));
const description = join(folder, 'openapi.json');

before(async () => {
  endWithThisProgram();
  const server = await Server.start();
  const response = await fetch(`${server.address}openapi.json`);
  writeFileSync(description, await response.text());
  await server.stop();
});

after(() => rmSync(folder, { recursive: true, force: true }));

test("Redocly's linter finds no error", async () => {
  const config = await createConfig({ extends: ['recommended'] });
  const problems = await lint({ ref: description, config });
  const errors = problems.filter((problem) => problem.severity === 'error');
  assert.deepEqual(
    errors.map((error) => `${error.location[0].pointer}: ${error.message}`),
    [],
  );
});

test('swagger-parser reads it', async () => {
  await SwaggerParser.validate(description);
});
