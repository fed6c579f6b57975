/** Folders and programs, as CTest and ./scanloom pass them. */

export function required(name) {
  const value = process.env[name];
  if (!value) throw new Error(`${name} is not set: run this with ctest -L e2e or ./scanloom bench`);
  return value;
}
