/** Paths of folders and programs, which CTest and ./scanloom pass in the environment. */

export function required(name) {
  const value = process.env[name];
  if (!value) throw new Error(`${name} is not set: run this with ctest -L e2e or ./scanloom bench`);
  return value;
}
