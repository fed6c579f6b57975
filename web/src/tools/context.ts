/** What tools work on. */
import type OlMap from 'ol/Map';
import type { Robot, Session } from '../api/types';
import type { Picture } from '../picture';
import type { Theme } from '../theme';

export interface ToolContext {
  map: OlMap;
  /** The map's element. */
  target: HTMLElement;
  theme: () => Theme;
  /** The one that is open. */
  session: () => Session | null;
  robots: () => Robot[];
  picture: Picture;
}

/** The weave whose maps are seen in the session's place, as when it is shown as it was; null: its own. */
export function shownWeave({ picture }: ToolContext): string | null {
  return picture.main?.source.weave ?? null;
}
