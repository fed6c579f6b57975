/** Runs of scanloom-load against a server of their own. */
import { Server, endWithThisProgram, start } from '../e2e/programs.mjs';

endWithThisProgram();

/** A server that says nothing but what goes wrong, so that figures are not buried. */
export function startServer() {
  return Server.start(['--log-level', 'warn']);
}

/**
 * What the tool tells of each second is not shown, unless it fails.
 * @returns the report of one run; throws where something was lost or could not be verified
 */
export async function load(server, options) {
  const flags = Object.entries(options).flatMap(([name, value]) =>
    value === true ? [`--${name}`] : [`--${name}`, String(value)],
  );
  const child = start(
    'scanloom-load',
    [
      '--server',
      `127.0.0.1:${server.robotPort}`,
      '--http',
      `127.0.0.1:${server.httpPort}`,
      '--json',
      '-',
      '--replace',
      ...flags,
    ],
    { stderr: 'pipe' },
  );
  const [text, told] = await Promise.all([textOf(child.stdout), textOf(child.stderr)]);
  if (!text.includes('{')) throw new Error(`scanloom-load gave no report:\n${told}`);
  const report = JSON.parse(text.slice(text.indexOf('{')));
  if (!report.verdict.nothing_lost) throw new Error(`${report.verdict.sentence}\n${told}`);
  return report;
}

async function textOf(stream) {
  let text = '';
  for await (const piece of stream) text += piece;
  return text;
}
