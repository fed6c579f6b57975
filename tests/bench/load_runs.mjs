/** Runs scanloom-load, each run with its own server. */
import { Server, endWithThisProgram, start } from '../e2e/programs.mjs';

endWithThisProgram();

/** A server that logs only errors, so that figures stay readable. */
export function startServer(options = [], database = undefined) {
  return Server.start(['--log-level', 'warn', ...options], database);
}

/**
 * The tool's output of each second is not shown, unless the tool fails.
 * @param servers  one, or several that share a store
 * @returns the report of one run; throws if scans were lost or could not be verified
 */
export async function load(servers, options) {
  const all = [servers].flat();
  const flags = Object.entries(options).flatMap(([name, value]) =>
    value === true ? [`--${name}`] : [`--${name}`, String(value)],
  );
  const child = start(
    'scanloom-load',
    [
      '--server',
      all.map((each) => `127.0.0.1:${each.robotPort}`).join(','),
      '--http',
      `127.0.0.1:${all[0].httpPort}`,
      '--json',
      '-',
      '--replace',
      ...flags,
    ],
    { stderr: 'pipe' },
  );
  const [text, log] = await Promise.all([textOf(child.stdout), textOf(child.stderr)]);
  if (!text.includes('{')) throw new Error(`scanloom-load gave no report:\n${log}`);
  const report = JSON.parse(text.slice(text.indexOf('{')));
  if (!report.verdict.nothing_lost) throw new Error(`${report.verdict.sentence}\n${log}`);
  return report;
}

async function textOf(stream) {
  let text = '';
  for await (const piece of stream) text += piece;
  return text;
}
