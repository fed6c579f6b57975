/** Instructions for pointing at the map: a mouse clicks, a finger taps, and only a keyboard has keys. */

/** Whether the main pointer is a finger. */
export function isTouch(): boolean {
  return matchMedia('(pointer: coarse)').matches;
}

/**
 * Returns the sentence that asks the user to pick something on the map: "Tap the start." or "Click the start, or ...".
 *
 * @param what what to pick, as "the start of the path"
 */
export function pickSentence(what: string, touch = isTouch()): string {
  if (touch) return `Tap ${what}.`;
  return `Click ${what}, or move the map with the arrow keys and press Enter.`;
}
