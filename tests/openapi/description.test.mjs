// The description of the HTTP API passes a linter and a parser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import SwaggerParser from '@apidevtools/swagger-parser';
import { createConfig, lint } from '@redocly/openapi-core';

const description = new URL('../../server/http/openapi.json', import.meta.url).pathname;

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
