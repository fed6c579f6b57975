/** The line between the two sides of the map, moved with the pointer or the arrow keys. */
import type { Picture } from '../picture';

const kStep = 0.02;
const kLeap = 0.1;

export class SwipeHandle {
  constructor(
    private readonly handle: HTMLElement,
    private readonly stage: HTMLElement,
    private readonly picture: Picture,
  ) {
    handle.addEventListener('pointerdown', (event) => {
      handle.setPointerCapture(event.pointerId);
      event.preventDefault();
      handle.focus();
    });
    handle.addEventListener('pointermove', (event) => {
      if (handle.hasPointerCapture(event.pointerId)) this.moveTo(this.shareOf(event.clientX));
    });
    handle.addEventListener('keydown', (event) => this.press(event));
    picture.listen(() => this.show());
    this.show();
  }

  private press(event: KeyboardEvent): void {
    const { divider } = this.picture.now;
    const steps: Record<string, number> = {
      ArrowLeft: divider - kStep,
      ArrowDown: divider - kStep,
      ArrowRight: divider + kStep,
      ArrowUp: divider + kStep,
      PageDown: divider - kLeap,
      PageUp: divider + kLeap,
      Home: 0,
      End: 1,
    };
    const to = steps[event.key];
    if (to === undefined) return;
    event.preventDefault();
    this.moveTo(to);
  }

  private moveTo(share: number): void {
    this.picture.change({ divider: Math.min(1, Math.max(0, share)) });
  }

  private shareOf(clientX: number): number {
    const { left, width } = this.stage.getBoundingClientRect();
    return (clientX - left) / width;
  }

  private show(): void {
    const percent = Math.round(100 * this.picture.now.divider);
    this.handle.hidden = !this.picture.isSwiping;
    this.handle.style.left = `${100 * this.picture.now.divider}%`;
    this.handle.setAttribute('aria-valuenow', String(percent));
    this.handle.setAttribute('aria-valuetext', `${percent} % of the width shows the first map`);
  }
}
