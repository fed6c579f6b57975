/** How a bench was called. `--quick` asks for shorter and fewer runs, which show that it works and little more. */
export const quick = process.argv.includes('--quick');

/** All that was named besides. */
export const named = process.argv.slice(2).filter((argument) => argument !== '--quick');

/** What a full run takes, or a quick one. */
export function fullOrQuick(full, short) {
  return quick ? short : full;
}

/** Says at the start how long it will take, on two cores. */
export function announce(what, full, short) {
  console.log(`${what}: takes about ${quick ? `${short}, as it is quick: do not trust its figures` : full}\n`);
}
