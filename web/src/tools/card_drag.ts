/** Dragging the card of the open tool by its header, so that it covers no place that a person wants to pick. */

/**
 * The card moves within `stage` only: none of it is cut off. On phones the style sheet ignores where it was dragged.
 *
 * @param card   takes the custom properties --dragged-x and --dragged-y
 * @param handle the part of the card to drag it by
 */
export function makeDraggable(card: HTMLElement, handle: HTMLElement, stage: HTMLElement): void {
  let at = { x: 0, y: 0 };
  const moveTo = (x: number, y: number): void => {
    const [inner, outer] = [card.getBoundingClientRect(), stage.getBoundingClientRect()];
    if (inner.width === 0) return;
    // Where the card would be if it had not been dragged.
    const [left, top] = [inner.left - at.x, inner.top - at.y];
    at = {
      x: within(x, outer.left - left, outer.right - left - inner.width),
      y: within(y, outer.top - top, outer.bottom - top - inner.height),
    };
    card.style.setProperty('--dragged-x', `${at.x}px`);
    card.style.setProperty('--dragged-y', `${at.y}px`);
  };

  handle.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || isButton(event.target) || getComputedStyle(card).translate === 'none') return;
    const from = { x: at.x - event.clientX, y: at.y - event.clientY };
    const done = new AbortController();
    const { signal } = done;
    handle.setPointerCapture(event.pointerId);
    card.classList.add('dragging');
    handle.addEventListener('pointermove', (move) => moveTo(from.x + move.clientX, from.y + move.clientY), { signal });
    handle.addEventListener(
      'lostpointercapture',
      () => {
        done.abort();
        card.classList.remove('dragging');
      },
      { signal },
    );
  });
  // A card or window that changes its size must not leave the card half outside.
  const resized = new ResizeObserver(() => {
    if (getComputedStyle(card).translate !== 'none') moveTo(at.x, at.y);
  });
  resized.observe(card);
  resized.observe(stage);
}

function isButton(target: EventTarget | null): boolean {
  return target instanceof Element && target.closest('button') !== null;
}

function within(value: number, least: number, most: number): number {
  return Math.max(least, Math.min(most, value));
}
