/** The arguments of a bench. `--quick` selects shorter and fewer runs, which only show that the bench works. */
export const quick = process.argv.includes('--quick');

/** All other arguments. */
export const operands = process.argv.slice(2).filter((argument) => argument !== '--quick');

/** Returns the value for a full run, or for a quick one. */
export function fullOrQuick(full, short) {
  return quick ? short : full;
}

/** Prints at the start how long the bench takes, on two cores. */
export function announce(what, full, short) {
  console.log(`${what}: takes about ${quick ? `${short}, as a quick run: its figures are not reliable` : full}\n`);
}
