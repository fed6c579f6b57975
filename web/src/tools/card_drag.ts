/** Drags the card of the open tool by its header, so that the user can uncover any place. */

/**
 * Keeps the card entirely within `stage`. On phones the style sheet ignores the dragged position.
 *
 * @param card   takes the custom properties --dragged-x and --dragged-y
 * @param handle the part of the card to drag it by
 */
export function makeDraggable(card: HTMLElement, handle: HTMLElement, stage: HTMLElement): void {
  let at = { x: 0, y: 0 };
  const moveTo = (x: number, y: number): void => {
    const [inner, outer] = [card.getBoundingClientRect(), stage.getBoundingClientRect()];
    if (inner.width === 0) return;
    // The position of the card without dragging.
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
  // After a change of the card's or the window's size, the card must still be entirely visible.
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
